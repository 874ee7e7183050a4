// synth/scene/kinds/transfer.h — a designed motion with the look of an exemplar (Jamriska et al. 2015).
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "media/frame/filmed_ground.h"
#include "synth/scene/kinds/kind.h"

namespace freshet::synth::scene {

struct TransferMotion {
  static constexpr const char* kName = "transfer";
  static constexpr Pixels kPixels = Pixels::kOwn;

  std::filesystem::path design_alpha{}, design_flow{}, exemplar{}, exemplar_alpha{};
  media::Ground ground = media::Ground::kNone;
  cv::Point at{0, 0};  // px, of its upper left corner in the picture
};

template <>
const std::vector<Key<TransferMotion>>& keys_of<TransferMotion>();

}  // namespace freshet::synth::scene
