// synth/scene/rendering/composite.h — layers, each where it is at a moment, over each other.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/motion/motion.h"
#include "synth/scene/rendering/sprite.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// Light that falls on layers, besides the still's own: a pixel's channels are multiplied by 1 + gain * falloff. What
/// several bring is added before.
struct FallingLight {
  const cv::Mat* falloff = nullptr;  // CV_32F, of the picture
  std::array<float, 3> gain{};       // blue, green, red
};

/// A layer as it is composited; borrows both.
struct MovedSprite {
  const Sprite* sprite = nullptr;
  const Motion* motion = nullptr;
  Blend blend = Blend::kOver;
  /// Factors of the light that falls on it, of each pixel of the picture, CV_32F, and of all of it; null: 1.
  std::array<const cv::Mat*, 2> lights{};
  const float* lit = nullptr;
  /// Whether the first of the lights moves as the layer's colours do: a pixel has that of the place it shows.
  bool light_moves = false;
  std::span<const FallingLight* const> falling{};
};

/// Composites the layers at the frame that their motions have gone to.
///
/// Row by row and from the nearest layer on, so that nothing is sampled that nearer layers hide; a pixel's colour is
/// the same as from back to front in premultiplied form (Porter and Duff 1984): each blend lets a share of each channel
/// of what lies behind through, whatever that is. A displacement is rounded to 1/64 px, and sampled by Keys' cubic,
/// which leaves as it is what does not move.
///
/// out      CV_8UC3, or CV_32FC4 (colours times alpha, and alpha), of the picture's size; overwritten. Where no layer
///          is, 0.
/// Cost     bench/scene/scene.cc. The same bits for any number of threads.
void composite(std::span<const MovedSprite> nearest_first, cv::Mat& out);

}  // namespace freshet::synth::scene
