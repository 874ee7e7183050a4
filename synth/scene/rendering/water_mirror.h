// synth/scene/rendering/water_mirror.h — what the water mirrors moves there too.
#pragma once

#include <opencv2/core.hpp>

#include "synth/scene/rendering/sprite.h"
#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// The still's water holds the mirror image of a sky and trees that stand still. Each frame, the change of what lies
/// above the horizon is mirrored about it and added to the water's pixels, before waves move them: mirrored clouds
/// drift with the clouds, mirrored trees sway with theirs.
///
/// How much of a change comes back is measured on the still: by channel, the slope of the water's colours over those
/// that they mirror (0..1; least squares, thrice, with what fits badly counting little), times at each place how well
/// that holds there. Where a picture's water mirrors something else, nothing happens.
class WaterMirror {
 public:
  /// water     its sprite, whose outline is held. horizon   in px of the picture.
  /// unmoved   CV_32FC4 of the picture's size, colours times alpha: all but the water, as the still has it.
  WaterMirror(const Sprite& water, const Line& horizon, const cv::Mat& unmoved);

  /// Writes the sprite's texture for a frame. moved   as unmoved, of this frame.
  /// Cost     a sampling of the sprite's box.
  void reflect(const cv::Mat& moved, Sprite& water);

  /// CV_32FC4, of the texture's samples: of a change how much comes back; of alpha, 0.
  const cv::Mat& share() const { return share_; }

 private:
  /// What stands above the horizon, at the texture's samples.
  void mirror(const cv::Mat& picture, int beyond, cv::Mat& out) const;

  cv::Matx23d to_picture_;  // from the texture's samples
  cv::Mat own_, unmoved_;   // CV_32FC4, of the texture's size
  cv::Mat mirrored_, share_;
};

}  // namespace freshet::synth::scene
