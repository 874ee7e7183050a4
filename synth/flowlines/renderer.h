// synth/flowlines/renderer.h — output frames from a clip's frames and the moments that each place shows.
#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/moments.h"

namespace freshet::synth::flowlines {

enum class Mixing {
  kFeather,   // as printed: textures averaged by their weights, which washes out where they are unlike
  kContrast,  // the same with the contrast about the clip's mean kept
  kCut,       // cut where the textures are most alike, and mixed so only next to the cut
};

struct RenderOptions {
  Mixing mixing = Mixing::kCut;
  /// CV_32F, the frames' size: how alike two unrelated moments are taken to be where they are mixed, 0..1. Empty: .5.
  cv::Mat likeness{};
};

/// Of dense textures, such as foam, a mix of two has less detail than either, as if they were unlike; of sparse ones,
/// such as flames on black, it has as much as both, as if they were alike, and would gain contrast that it never had;
/// and what stands still is alike. Measured on pairs of frames half a clip apart, around each place.
/// frames    CV_8UC3, 4 or more. window_px   side of a place's surroundings.
/// Returns   CV_32F, the frames' size, 0..1.
cv::Mat likeness_of(const std::vector<cv::Mat>& frames, double window_px);

/// Renders what stays where it was: every place shows itself at other moments.
class Renderer {
 public:
  /// frames    CV_8UC3; kept by reference.
  /// working   px of the picture that moments are given for: the frames' size, or smaller.
  Renderer(const std::vector<cv::Mat>& frames, cv::Size working, const RenderOptions& options = {});
  /// The moments of one frame as a picture, CV_8UC3. All threads, any number gives the same.
  void render(const std::vector<Moment>& moments, cv::Mat& out) const;
  /// The clip's mean, CV_32FC3.
  const cv::Mat& mean() const { return mean_; }

 private:
  void row(const std::vector<Moment>& moments, int y, cv::Mat& out) const;

  const std::vector<cv::Mat>* frames_;
  cv::Size working_;
  RenderOptions options_;
  cv::Mat mean_;
};

/// Values of a moment's frames, BGR 0..255, mixed.
cv::Vec3f mixed(const std::array<cv::Vec3f, 4>& values, const Moment& moment, const cv::Vec3f& mean,
                float likeness, Mixing mixing);

}  // namespace freshet::synth::flowlines
