// synth/stills/between/pinned_flow.h — the flow between two stills, corrected where a person pinned it.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/between/flow_pair.h"
#include "synth/stills/between/flow_pins.h"

namespace freshet::synth::stills {

/// What pins carry from one still to the other, before what lies behind it.
struct CarriedThing {
  cv::Rect box;     // px of the flow, in the one still: all of it lies there
  cv::Mat move;     // CV_32FC2 of the box, px: smooth, beyond the thing too
  cv::Mat opacity;  // CV_32F of the box, 0..1: how much of a pixel is its

  /// Where of the one still that lay which has come to a place after a part (0..1) of its way, and how much of it is
  /// the thing's; opacity 0 where none has.
  struct Origin {
    cv::Point2f at, move;
    float opacity = 0;
  };
  Origin origin(cv::Point2f place, float part) const;
  /// px that any of it can touch on its way.
  cv::Rect way(cv::Size flow) const;
};

struct PinnedFlow {
  FlowPair flow;                     // with the things' own where they are
  FlowPair behind;                   // what is behind them, continued where they hide it
  std::vector<CarriedThing> things;  // one for each of joined_pins
  cv::Mat hidden_a, hidden_b;        // CV_32F, 0..1: how much things hide in the one still, and in the other
  cv::Rect changed;                  // px; elsewhere both flows are what they were, to the bit
};

/// Pins say of a smooth motion where it leads (PinnedMotion). It is refined by what the pictures show: three
/// times each place looks some px about for what is most alike, and takes from its neighbours what they are
/// sure of. A smallest cut then parts the thing that moves so from the rest: what this motion explains better,
/// in either still, than what was found does. Where both explain a texture equally (waves, grass, a fence), and
/// where neither explains a place, the pins decide within their reach. What pins enclose (three or more) and
/// what the thing encloses goes along. At each pin the flow forth is its own within half a pixel; the flow back
/// is the inverse of the forth, and so is its own at where it goes. Behind things both flows are continued from
/// where they agree.
/// from, to   as flow_between's. flow   of them. pins   inside the pictures, farther from each other than 2 px.
/// stop       asked between steps of a tenth of a second or so, a cut in one piece; what is returned then is not whole.
/// Source     Lin et al. 2007, Sec. 7, ask for it and have none.
/// Cost       CPU seconds for 960 x 783: 1.5 for a pin whose reach is 77 px, 5.7 for 14 on a third of the
///            picture.
PinnedFlow pinned_flow(const cv::Mat& from, const cv::Mat& to, const FlowPair& flow,
                       std::span<const FlowPin> pins, const std::stop_token& stop = {});

inline constexpr float kMostMissed = 900;  // grey levels squared: a pixel that is more unlike is as unlike
/// How unlike two pictures (CV_32FC3 of one size) are about each pixel: mean of squares over channels,
/// kMostMissed at most, and over a Gaussian window of that sigma, px. CV_32F.
cv::Mat mismatch(const cv::Mat& a, const cv::Mat& b, double window);

}  // namespace freshet::synth::stills
