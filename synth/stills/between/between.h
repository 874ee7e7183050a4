// synth/stills/between/between.h — what a scene looks like between two stills of it that lie far apart.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/between/pinned_flow.h"

namespace freshet::synth::stills {

/// Where the values of a picture between two stills come from.
struct Moment {
  /// At every place of the field, px to be added to it: where it lies in one still, and in the other.
  struct Source {
    cv::Vec2f a, b;
    float trust = 0;  // 0..1; the rest is the cross-fade's
  };
  cv::Size size;  // of this field: a half of the flow's, for a quarter of the time and no difference to see
  cv::Size flow;  // px that the vectors count
  std::vector<Source> source;  // row by row; empty: cross-fade everywhere
  float phase = 0;             // 0: all from one still, 1: all from the other

  // Where a person pinned the flow; empty: nowhere. Row by row as the sources.
  std::vector<Source> front;  // of a thing before the others; trust is its opacity
  std::vector<float>
      lean;  // to be added to the phase, behind it: away from the still in which a thing hides it
};

/// The flow between two stills, and how far it is to be trusted where.
class Between {
 public:
  /// Trust is 1 / (1 + (m / .3)^2), where m is how far forth and back miss each other, beside the way that
  /// they go, both in the mean over a tenth of the longer side: each way is found for itself, and only what
  /// is there is found by both. How alike the two ends of a motion are proves nothing where much is alike
  /// (flames): weighing by it as well, or by two scales of detail, gained nothing on sixteen other clips.
  explicit Between(const FlowPair& flow);
  /// With what a person pinned. Things go before what lies behind, which comes from the still that shows it; how
  /// much both ways agree counts the corrected flow. unpinned   what was corrected. Elsewhere all is as without.
  Between(const FlowPair& unpinned, const PinnedFlow& pinned);

  /// phase   0..1. Of the two guesses (what goes along the flow of one still, and of the other) the mean.
  /// Cost    CPU seconds for 1280 x 960: .05. Safe from many threads.
  Moment at(double phase) const;

 private:
  void add_things(Moment& moment) const;

  FlowPair flow_;  // shared; behind all things
  cv::Mat trust_;  // CV_32F, of the field's size
  std::vector<CarriedThing> things_;
  cv::Mat hidden_a_, hidden_b_;  // as PinnedFlow has them
  cv::Rect changed_;             // px of the flow
};

/// Reads the picture at a moment as the two stills have it together. Bicubic (Catmull-Rom): linear samples
/// between pixels took up to 2 dB of fine detail that a cross-fade keeps.
class MomentReader {
 public:
  /// a, b   CV_8UC3 or CV_16UC3, the stills at full size, of which the moment's flow covers `box`. All are
  ///        borrowed.
  MomentReader(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box);
  MomentReader(Moment&&, const cv::Mat&, const cv::Mat&, const cv::Rect&) = delete;

  /// Row `y` of the box: 3 floats for each of its columns, in the stills' own units; a little beyond them
  /// where contrast is high. One thread.
  void row(int y, float* out);

 private:
  const Moment& moment_;
  const cv::Mat &a_, &b_;
  cv::Rect box_;
  std::vector<Moment::Source> line_, front_;  // of the field, at the row's height
  std::vector<float> lean_;
};

/// All rows: a CV_32FC3 of the box's size.
cv::Mat moment_picture(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box);

}  // namespace freshet::synth::stills
