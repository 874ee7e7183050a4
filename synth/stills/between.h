// synth/stills/between.h — what a scene looks like between two stills of it that lie far apart.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::stills {

/// Flow between two stills, both ways, as 16-bit numbers of kUnit px: half the bytes of floats.
struct FlowPair {
  static constexpr float kUnit = 1.0f / 32;  // px of the pictures it was found on
  cv::Mat forth, back;                       // CV_16SC2: what lies at p in one lies at p + flow in the other
};

/// from, to   CV_8UC3 of one size, at least 64 px a side.
/// DIS at a quarter of the size (what has gone far is near there), then at full size from what that found,
/// each way for itself.
/// Source   in place of Bergen et al. 1992, which Lin et al. 2007 take. Cost   CPU seconds for 1280 x 960:
///          .3.
FlowPair flow_between(const cv::Mat& from, const cv::Mat& to);

/// Where the values of a picture between two stills come from. Two guesses follow the flow of one still
/// each; the third is the cross-fade, which follows none.
struct Moment {
  /// At every place of the field: from one still, from the other, once more by the second guess.
  struct Source {
    cv::Vec2f a1, b1, a2, b2;  // to be added to the place
    float w1 = 0, w2 = 0;      // of the guesses, 0..1; 1 - w1 - w2 is the cross-fade's
  };
  cv::Size size;  // of this field: a half of the flow's, for a quarter of the time and no difference to see
  cv::Size flow;  // px that the vectors count
  std::vector<Source> source;  // row by row; empty: cross-fade everywhere
  float phase = 0;             // 0: all from one still, 1: all from the other
};

/// Two stills and the flow between them, as any moment between needs them.
class Between {
 public:
  /// from, to   as flow_between had them; they are shared.
  Between(const cv::Mat& from, const cv::Mat& to, const FlowPair& flow);

  /// phase   0..1. A guess counts by how alike the two ends of its motion are beside the two stills in place
  /// (the squared ratio of their mean squared differences), and by how well forth and back agree. So what
  /// motion does not explain fades over.
  /// Cost   CPU seconds for 1280 x 960: .25. Safe from many threads.
  Moment at(double phase) const;

 private:
  cv::Mat from_, to_, forth_, back_;  // CV_8UC3; CV_32FC2
  cv::Mat unlikeness_;                // CV_32F: of the stills in place
};

/// The picture at a place as the two stills have it together.
/// a, b   CV_8UC3 or CV_16UC3, the stills at full size, of which the moment's flow covers `box`.
/// One row of the box: `y` of it, columns 0 .. box.width - 1, 3 floats each into `out`, in the stills' own
/// units. Safe from many threads.
void moment_row(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box, int y,
                float* out);

/// All rows: a CV_32FC3 of the box's size.
cv::Mat moment_picture(const Moment& moment, const cv::Mat& a, const cv::Mat& b, const cv::Rect& box);

}  // namespace freshet::synth::stills
