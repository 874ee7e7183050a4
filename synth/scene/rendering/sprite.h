// synth/scene/rendering/sprite.h — a layer's pixels, ready to be sampled between pixels.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// What the outline of a layer does.
enum class Outline {
  kMoves,   // with its colours, as in the paper
  kHeld,    // it stays where it is; what moves inside goes on beyond it
  kCyclic,  // held, and what moves inside comes round along x
};

/// Colours and alpha over the smallest box that holds the layer.
struct Sprite {
  static constexpr int kBorder = 2;       // samples around the box that a cubic needs
  static constexpr int kTransparent = 3;  // px of nothing around what moves, as far as the picture goes

  Outline outline = Outline::kMoves;
  cv::Rect box;  // px of the picture; empty: there is nothing of the layer
  cv::Mat
      texture;  // CV_32FC4, BGR times alpha and alpha, with kBorder all around; wider than the box when cyclic
  cv::Mat held;  // CV_32F, alpha of the box's pixels; empty where the outline moves
  /// Of each of the box's rows, from where to where (box's columns) it is not transparent.
  std::vector<cv::Range> spans;

  int period() const { return texture.cols - 2 * kBorder; }
};

/// The smallest box of what is not transparent; empty when nothing is.
cv::Rect box_of(const cv::Mat& alpha);

/// Of the picture, what a layer in that box may move over.
cv::Rect around(const cv::Rect& box, cv::Size picture);

/// colour   CV_32FC3, straight; alpha   CV_32F, 0..1; both of the picture's size.
/// Beyond its outline, and beyond the picture, what is held goes on smoothly; what is cyclic with copies of itself
/// (cyclic_texture.h).
/// period   px, of what is cyclic: wider by 2 at least than the box of what is not transparent.
Sprite make_sprite(const cv::Mat& colour, const cv::Mat& alpha, Outline outline, int period = 0);

/// Of a frame that comes as it is: CV_32FC4, colours times alpha, of any size, or empty; its upper left corner lies at
/// `at`. picture   size; what lies outside is cut off. A sprite of this size and place is written anew without
/// allocation.
void set_frame(Sprite& sprite, const cv::Mat& frame, cv::Point at, cv::Size picture);

}  // namespace freshet::synth::scene
