// synth/tour/texture.h — a picture read under a homography, sharp where it grows and without aliasing where it shrinks.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::tour {

/// Colours times alpha, and alpha, at full size and halved again and again. Its memory is kept from picture to picture.
class Texture {
 public:
  /// What lies beyond the edges for the filter's taps: the picture mirrored, or nothing.
  enum class Beyond { kMirrored, kNothing };

  explicit Texture(cv::Size size, Beyond beyond);
  cv::Size size() const { return size_; }

  /// CV_8UC3, opaque.
  void set(const cv::Mat& bgr);
  /// The picture at full size, CV_32FC4, to be written; call filled() then.
  cv::Mat& plane() { return plane_; }
  void filled();

  /// Reads n places of a row, from x on: out[i] = the texture at homography * (x + i, y, 1), each the mean of what its
  /// pixel covers. Samples lie at whole numbers; what lies beyond the edges is mirrored, or nothing.
  /// homography   its third row gives more than 0 for all of them.
  /// Cost         20 ns a place where it grows, to 100 where it shrinks eight times more to one side than to the other.
  ///              Allocates nothing; safe from many threads.
  /// Source       16 samples a place (Catmull-Rom), in the two levels around the narrow side of what a pixel covers,
  ///              as often along the wide side as it is wider, up to eight times: trilinear filtering (Williams 1983)
  ///              as graphics cards do it where it is anisotropic.
  void read(const cv::Matx33d& homography, int x, int y, int n, cv::Vec4f* out) const;

 private:
  struct Level {
    cv::Mat padded;  // CV_32FC4, with kPad samples around it
    cv::Size size;
  };
  static constexpr int kPad = 4;
  void pad(Level& level) const;
  /// The mean around (x, y) of what a pixel covers: its column's side and its row's, px (x, y, x, y).
  void average(float x, float y, const float* side, cv::Vec4f& out) const;

  cv::Size size_;
  Beyond beyond_;
  cv::Mat plane_;  // levels_[0] without its rim
  std::vector<Level> levels_;
};

}  // namespace freshet::synth::tour
