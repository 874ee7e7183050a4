// synth/animate/still/finished_frame.h — luminance coloured, and laid into the picture through the matte.
#pragma once

#include <array>

#include <opencv2/core.hpp>

#include "synth/animate/still/carried_base.h"
#include "synth/animate/still/colour_curve.h"
#include "synth/animate/still/colour_model.h"
#include "synth/animate/still/colour_range.h"

namespace freshet::synth::animate {

/// The last step of every frame. All that does not change from frame to frame is held as planes of its own,
/// in the order in which it is read.
class FrameFinisher {
 public:
  /// model        of the picture (fit_colour). It keeps luma, as own_colour does: green follows from blue and red.
  /// curve        how what is carried changes its colour where its luminance is another now.
  /// own_colour   CV_32FC3: what colour does beside the model.
  /// still        CV_32FC3, 0..1 (finish_fluid: and above): what shows where the fluid does not; unchanged where a
  ///              matte is 0.
  /// range        colours beyond which none is made.
  FrameFinisher(const ColourModel& model, const ColourCurve& curve, const cv::Mat& own_colour,
                const cv::Mat& still, const ColourRange& range = {});

  /// luma     CV_32F.
  /// fluid    CV_32F, 0..1: the matte.
  /// carried  null, or what brings its colour with it.
  /// Returns  CV_8UC3. Safe from many threads.
  cv::Mat finish(const cv::Mat& luma, const cv::Mat& fluid, const CarriedFrame* carried) const;
  /// The fluid by itself, nothing rounded: CV_32FC4, colour times matte, and the matte. Over `still` it is what
  /// finish() gives. Colours end at 0 and at the brightest of `still`, 1 at least.
  cv::Mat finish_fluid(const cv::Mat& luma, const cv::Mat& fluid, const CarriedFrame* carried) const;

 private:
  ColourCurve curve_;
  ColourRange range_;
  float brightest_ = 1;
  cv::Mat ground_;  // CV_8UC3: still
  struct Chroma {
    cv::Mat slope, rest;  // CV_32F: colour = luma + slope * luma + rest
  };
  Chroma blue_, red_;
  std::array<cv::Mat, 3> still_;  // CV_16U, by channel, 1/128 grey levels

  struct Row;
};

}  // namespace freshet::synth::animate
