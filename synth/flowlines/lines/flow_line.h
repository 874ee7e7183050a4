// synth/flowlines/lines/flow_line.h — a line that particles of the fluid ride, from where they enter to where they
// leave.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::flowlines {

/// Samples one px apart (the last stretch may be shorter), at least two. Here (0, 0) is the middle of the picture's
/// upper left pixel: half a pixel less than in a hints::Stroke.
struct FlowLine {
  std::vector<cv::Point2f> points;
  std::string name{};
  /// How many times as fast particles ride as they did in the clip, > 0, at even distances from the line's beginning to
  /// its end; empty: 1.
  std::vector<float> speeds{};
  std::optional<float> time_s{};  // of the output, when an edited line lies here; none: always

  int samples() const { return static_cast<int>(points.size()); }
  /// Of the chain, px.
  float length() const { return static_cast<float>(points.size() - 1); }
};

/// The chain walked at even steps of `step` px. Fewer than two points, or no length: an empty line.
FlowLine evenly(const std::vector<cv::Point2f>& chain, std::string name = {}, float step = 1);

/// Unit vector along the line at a sample, over the samples within `reach` of it; a corner is turned in an arc.
/// Before the first sample and after the last it is theirs.
cv::Point2f tangent(const FlowLine& line, int sample, int reach = 4);

/// The point at an arc length, which may lie between samples; before the first and after the last it goes on straight.
cv::Point2f at(const FlowLine& line, float arc);

/// The line's speed at an arc length; before the first sample and after the last it is theirs.
float speed_at(const FlowLine& line, float arc);

/// Every coordinate times `by`, resampled: a line of a reduced picture in the picture.
FlowLine scaled(const FlowLine& line, float by);

}  // namespace freshet::synth::flowlines
