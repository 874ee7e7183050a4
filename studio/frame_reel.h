// studio/frame_reel.h — an animation's frames for the page, as they are made.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "studio/drawing/document.h"
#include "studio/labelled_picture.h"
#include "synth/animate/animate.h"
#include "synth/animate/staging.h"

namespace freshet::studio {

/// JPEGs of one animation, and where its fluid ends in each of them. Safe from many threads.
class FrameReel {
 public:
  /// first   which of the film's frames comes first; after the last one the film goes on from its beginning.
  FrameReel(std::uint64_t number, std::string stage, cv::Size size, int total, double fps, int first = 0);

  const std::uint64_t number;  // no other reel of this run has it
  const std::string stage;     // "small", "full", "layers"
  const cv::Size size;
  const int total;
  const double fps;
  const int first;

  void add(const cv::Mat& frame);
  int ready() const;
  std::optional<std::string> frame(int index) const;

  /// matte   CV_32F 0..1, of the next frame whose outline is not known yet.
  void add_outline(const cv::Mat& matte);
  /// Of each frame, the closed lines where its matte is one half, each "[x0,y0,x1,y1,..]" px of the reel. JSON; empty
  /// where the outline stands still.
  std::string outlines_json() const;

 private:
  mutable std::mutex guard_;
  std::vector<std::string> frames_;
  std::vector<std::vector<std::vector<cv::Point>>> outlines_;
};

/// What is animated, of one size. A copy of the labelled picture reduced by `factor`, or itself.
struct ReelScene {
  cv::Mat picture, matte;  // CV_8UC3, CV_8U
  cv::Mat held;            // CV_8U; empty: nothing
  cv::Mat tempo;           // draw_tempo(); empty: as filmed
  double factor = 1;
  bool motion_alone = false;  // for a first look (CarriedOptions::innovations)
};

/// What an animation is made of.
struct Rendering {
  query::Assignment assignment;  // of the scene's picture
  query::MotionGuide asked;
  synth::animate::Playing playing;
  synth::animate::AnimateOptions options;
};
Rendering rendering_of(const LabelledPicture& labelled, const Document& document, const ReelScene& scene,
                       int frames, double fps);

/// Renders what a labelling of a picture assigned into a reel.
/// told     called after each frame. Throws as synth::animate::animate.
void render(const LabelledPicture& labelled, const Document& document, const ReelScene& scene,
            FrameReel& reel, const std::function<void()>& told, const Job& job);

/// The mean motion that a labelling's animation has, CV_32FC2, px/s of the picture, of its size.
cv::Mat assigned_motion(const LabelledPicture& labelled, cv::Size picture);

}  // namespace freshet::studio
