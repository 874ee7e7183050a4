#include "synth/transfer/frame_report.h"

#include <fmt/format.h>

namespace freshet::synth::transfer {
namespace {

SegmentUse use_of(const NearestField& field, const std::vector<int>& sources,
                  const std::vector<int>& targets) {
  SegmentUse use;
  use.sources = static_cast<std::int64_t>(sources.size());
  use.targets = static_cast<std::int64_t>(targets.size());
  if (use.sources == 0) return use;
  use.min_uses = use.targets / use.sources;
  use.remainder = use.targets % use.sources;
  std::vector<std::int32_t> used(field.source_places(), 0);
  for (const int target : targets) {
    const std::int32_t source = field.source[static_cast<std::size_t>(target)];
    if (source >= 0) ++used[static_cast<std::size_t>(source)];
  }
  for (const int source : sources) {
    const std::size_t times = static_cast<std::size_t>(used[static_cast<std::size_t>(source)]);
    if (times >= use.sources_used.size()) use.sources_used.resize(times + 1, 0);
    ++use.sources_used[times];
  }
  return use;
}

// Back to the exemplar as it was given: (x, y) of a picture turned once lies at (w - 1 - y, x) of it.
cv::Vec3i given_place(const ExemplarLevel& source, ExemplarLevel::Place at) {
  int x = at.x, y = at.y;
  for (int turn = at.turn; turn > 0; --turn) {
    const cv::Size before = source.sizes[static_cast<std::size_t>(turn - 1)];
    const int turned_x = x;
    x = before.width - 1 - y;
    y = turned_x;
  }
  return {x, y, at.turn};
}

}  // namespace

void report_use(const NearestField& field, const Segments& source, const Segments& target,
                TransferredFrame& made) {
  const std::vector<int>&source_boundary = source[Segment::kBoundary],
        &source_interior = source[Segment::kInterior];
  if (!source_boundary.empty() && !source_interior.empty()) {
    made.boundary = use_of(field, source_boundary, target[Segment::kBoundary]);
    made.interior = use_of(field, source_interior, target[Segment::kInterior]);
    return;
  }
  const bool no_boundary = source_boundary.empty();
  made.remarks.push_back(fmt::format("the exemplar has no {}: its {} is used for both",
                                     no_boundary ? "boundary" : "interior",
                                     no_boundary ? "interior" : "boundary"));
  const Task task = tasks_of(source, target)[0];
  (no_boundary ? made.interior : made.boundary) = use_of(field, task.sources, task.targets);
}

void report_nearest(const NearestField& field, const ExemplarLevel& source, const Segments& target,
                    int margin, TransferredFrame& made) {
  const int width = field.target_width - 2 * margin, height = field.target_height - 2 * margin;
  made.nearest = cv::Mat(height, width, CV_32SC3, cv::Scalar::all(-1));
  made.distance = cv::Mat(height, width, CV_32F, cv::Scalar::all(0));
  const bool both =
      !source.segments[Segment::kBoundary].empty() && !source.segments[Segment::kInterior].empty();
  std::int64_t patches = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at = static_cast<std::size_t>((y + margin) * field.target_width + x + margin);
      if (field.source[at] < 0) continue;
      made.nearest.at<cv::Vec3i>(y, x) = given_place(source, source.split(field.source[at]));
      made.distance.at<float>(y, x) = field.distance[at];
      made.mean_distance += static_cast<double>(field.distance[at]);
      made.violations += both && source.segments.of.values[static_cast<std::size_t>(field.source[at])] !=
                                     target.of.values[at];
      ++patches;
    }
  if (patches > 0) made.mean_distance /= static_cast<double>(patches);
  if (patches == 0) made.remarks.push_back("the target's mask is empty: the frame is transparent");
}

}  // namespace freshet::synth::transfer
