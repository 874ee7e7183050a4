// synth/scene/kinds/transfer.h — a designed motion with the look of an exemplar (Jamriska et al. 2015).
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "synth/scene/kinds/kind.h"

namespace freshet::synth::scene {

/// What lies behind an exemplar that has no alpha of its own (transfer::Ground).
enum class ExemplarGround { kNone, kBlack, kWhite };

struct TransferMotion {
  static constexpr const char* kName = "transfer";
  static constexpr Pixels kPixels = Pixels::kOwn;

  std::filesystem::path design_alpha{}, design_flow{}, exemplar{}, exemplar_alpha{};
  ExemplarGround ground = ExemplarGround::kNone;
  cv::Point at{0, 0};  // px, of its upper left corner in the picture
};

template <>
const std::vector<Key<TransferMotion>>& keys_of<TransferMotion>();

}  // namespace freshet::synth::scene
