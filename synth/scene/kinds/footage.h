// synth/scene/kinds/footage.h — a sequence or video over the picture.
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

#include "media/frame/filmed_ground.h"
#include "synth/scene/kinds/kind.h"

namespace freshet::synth::scene {

struct FootageMotion {
  static constexpr const char* kName = "footage";
  static constexpr Pixels kPixels = Pixels::kOwn;

  std::filesystem::path file{};
  cv::Point at{0, 0};
  int width = 0;  // px that it is shown wide, in its own shape; 0: as it is
  double start_s = 0;
  bool repeats = true;
  /// Grey, of the film's shape: a picture, still over it, or one for each of its frames. Empty: none.
  std::filesystem::path matte{};
  media::Ground ground = media::Ground::kNone;
};

/// Of the scene, with which the footage begins.
int start_frame(const FootageMotion& footage, double fps);

template <>
const std::vector<Key<FootageMotion>>& keys_of<FootageMotion>();

}  // namespace freshet::synth::scene
