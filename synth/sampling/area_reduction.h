// synth/sampling/area_reduction.h — a plane reduced by averages of areas, only where it is needed.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// cv::resize with INTER_AREA within rounding, of chosen rectangles: a clip's frame is reduced for each
/// moment that is shown, and patches need a small part of it.
class AreaReduction {
 public:
  /// reduced   no larger than source.
  AreaReduction(cv::Size source, cv::Size reduced);
  cv::Size reduced() const { return {static_cast<int>(across_.size()), static_cast<int>(down_.size())}; }
  /// px of the source that a rectangle of the reduced plane is made of.
  cv::Rect source_of(const cv::Rect& rect) const;
  /// Writes rect of `out`, whose size is reduced(), from source_of(rect) of `plane`; both CV_32F.
  /// line   scratch.
  void apply(const cv::Mat& plane, const cv::Rect& rect, cv::Mat& out, std::vector<float>& line) const;

 private:
  struct Taps {
    int first = 0, count = 0;  // samples of the source
    std::size_t weights = 0;   // where theirs begin
  };
  static std::vector<Taps> taps(int source, int reduced, std::vector<float>& weights);

  std::vector<float> weights_;       // before its readers: they fill it
  std::vector<Taps> across_, down_;  // by reduced column, row
};

}  // namespace freshet::synth::sampling
