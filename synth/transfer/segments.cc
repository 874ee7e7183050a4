#include "synth/transfer/segments.h"

#include <algorithm>

namespace freshet::synth::transfer {

void segment(const Grid& blurred_alpha, double lower, double upper, int margin, Segments& out) {
  out.of = GridOf<Segment>(blurred_alpha.width, blurred_alpha.height, Segment::kNone);
  for (int y = margin; y < blurred_alpha.height - margin; ++y)
    for (int x = margin; x < blurred_alpha.width - margin; ++x) {
      const double alpha = static_cast<double>(blurred_alpha(x, y));
      if (alpha > lower) out.of(x, y) = alpha < upper ? Segment::kBoundary : Segment::kInterior;
    }
  list_segments(out);
}

void list_segments(Segments& segments) {
  for (std::vector<int>& list : segments.list) list.clear();
  const int width = segments.of.width, height = segments.of.height;
  for (int top = 0; top < height; top += kTile)
    for (int left = 0; left < width; left += kTile)
      for (int y = top; y < std::min(top + kTile, height); ++y)
        for (int x = left; x < std::min(left + kTile, width); ++x) {
          const Segment segment = segments.of(x, y);
          if (segment != Segment::kNone)
            segments.list[static_cast<std::size_t>(segment)].push_back(y * width + x);
        }
}

std::vector<Task> tasks_of(const Segments& source, const Segments& target) {
  const std::vector<int>&source_boundary = source[Segment::kBoundary],
        &source_interior = source[Segment::kInterior];
  const std::vector<int>&boundary = target[Segment::kBoundary], &interior = target[Segment::kInterior];
  if (!source_boundary.empty() && !source_interior.empty())
    return {{source_boundary, boundary}, {source_interior, interior}};
  // In the order of Segments, as one list.
  Segments all;
  all.of = target.of;
  for (Segment& of : all.of.values)
    if (of == Segment::kBoundary) of = Segment::kInterior;
  list_segments(all);
  return {{source_interior.empty() ? source_boundary : source_interior, all[Segment::kInterior]}};
}

}  // namespace freshet::synth::transfer
