#include "synth/animate/placement.h"

#include <algorithm>
#include <limits>

namespace freshet::synth {

bool coherent(const PlacedPatch& a, const PlacedPatch& b) {
  return a.clip == b.clip && a.variant == b.variant && a.patch - a.piece == b.patch - b.piece;
}

cv::Rect canvas_of(const Placement& placement) {
  if (placement.patches.empty()) return {};
  cv::Point low(std::numeric_limits<int>::max(), std::numeric_limits<int>::max());
  cv::Point high(std::numeric_limits<int>::min(), std::numeric_limits<int>::min());
  for (const PlacedPatch& placed : placement.patches) {
    low = {std::min(low.x, placed.piece.x), std::min(low.y, placed.piece.y)};
    high = {std::max(high.x, placed.piece.x), std::max(high.y, placed.piece.y)};
  }
  return {low, cv::Size(high.x - low.x + placement.side, high.y - low.y + placement.side)};
}

}  // namespace freshet::synth
