// synth/flowlines/renderer.h — output frames from a clip's frames and the moments that each place shows.
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/moments.h"

namespace freshet::synth::flowlines {

enum class Mixing {
  kFeather,   // as printed: textures averaged by their weights, which washes out where they are unlike
  kContrast,  // the same with the fine detail given back that it costs
  kCut,       // cut where the textures are most alike, and mixed so only next to the cut
};

struct RenderOptions {
  Mixing mixing = Mixing::kCut;
  /// CV_32F, the frames' size: how alike two unrelated moments are taken to be where they are mixed, 0..1. Empty: .5.
  cv::Mat likeness{};
  /// Side of the surroundings that fine detail is finer than, px: odd.
  int detail_px = 7;
};

/// Of dense textures, such as foam, a mix of two has less detail than either, as if they were unlike; of sparse ones,
/// such as flames on black, it has as much as both, as if they were alike, and would gain contrast that it never had;
/// and what stands still is alike. Measured on pairs of frames half a clip apart, around each place.
/// frames    CV_8UC3, 4 or more. window_px   side of a place's surroundings.
/// Returns   CV_32F, the frames' size, 0..1.
cv::Mat likeness_of(const std::vector<cv::Mat>& frames, double window_px);

/// What must be added to a mix's fine detail, as a share of it, for it to have as much as each of its frames: 0 for one
/// frame, or for frames that are alike. Weights sum to 1.
float lost_detail(const Moment& moment, float likeness, Mixing mixing);

/// Adds to fine detail its share `lost`: to what of picture - mean is finer than its surroundings. What is larger is
/// left as it was mixed: runs are alike in it, and given back it came and went for all to see.
class DetailReturn {
 public:
  /// picture   CV_8UC3, changed. mean   CV_8UC3. lost   CV_32F, >= 0. All of one size.
  /// side      of the surroundings, px: odd. All threads; the same for any number.
  void operator()(cv::Mat& picture, const cv::Mat& mean, const cv::Mat& lost, int side);

 private:
  cv::Mat difference_, around_;  // scratch
};

/// Renders what stays where it was: every place shows itself at other moments.
class Renderer {
 public:
  /// frames    CV_8UC3; kept by reference.
  /// working   px of the picture that moments are given for: the frames' size, or smaller.
  Renderer(const std::vector<cv::Mat>& frames, cv::Size working, const RenderOptions& options = {});
  /// The moments of one frame as a picture, CV_8UC3. All threads, any number gives the same.
  void render(const std::vector<Moment>& moments, cv::Mat& out);
  /// The clip's mean, CV_8UC3.
  const cv::Mat& mean() const { return mean_; }

 private:
  void row(const std::vector<Moment>& moments, int y, cv::Mat& out);

  const std::vector<cv::Mat>* frames_;
  cv::Size working_;
  RenderOptions options_;
  cv::Mat mean_, lost_;
  DetailReturn return_detail_;
};

/// Values of a moment's frames, BGR 0..255, averaged by their weights.
cv::Vec3f mixed(const std::array<cv::Vec3f, 4>& values, const Moment& moment);

}  // namespace freshet::synth::flowlines
