#include "synth/animate/placement/placement.h"

#include <algorithm>
#include <limits>
#include <string>

#include "freshet/error.h"
#include "synth/animate/placement/pieces_picture.h"

namespace freshet::synth::animate {

void check(const Placement& placement) {
  if (placement.patches.empty())
    throw Error(ErrorKind::kInput, "placement", "it holds no piece",
                "Give a matte that covers some of the picture");
  const int side = placement.side, stride = placement.stride;
  if (side < 8 || stride < 4 || side % 4 != 0 || stride % 4 != 0 || stride > side || side > 4 * stride)
    throw Error(ErrorKind::kInput, "placement",
                "pieces of " + std::to_string(side) + " px every " + std::to_string(stride) +
                    " px; multiples of 4 px expected, and a stride of a quarter of the side to all of it",
                "Label the picture again: freshet query label");
}

Placement halved(const Placement& placement) {
  Placement half = placement;
  half.side /= 2;
  half.stride /= 2;
  half.piece_scale *= 2;
  // Down to whole pixels: pieces that lie a stride apart still do.
  const auto down = [](int at) { return at >= 0 ? at / 2 : -((1 - at) / 2); };
  for (PlacedPatch& placed : half.patches) {
    placed.piece = {down(placed.piece.x), down(placed.piece.y)};
    placed.patch = {down(placed.patch.x), down(placed.patch.y)};
  }
  return half;
}

int common_step(const Placement& placement, int max_step) {
  int step = 1;
  while (2 * step <= max_step && placement.side % (2 * step) == 0 && placement.stride % (2 * step) == 0)
    step *= 2;
  return step;
}

bool coherent(const PlacedPatch& a, const PlacedPatch& b) {
  return a.clip == b.clip && a.variant == b.variant && a.speed == b.speed &&
         a.patch - a.piece == b.patch - b.piece;
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

cv::Matx23d squares_from_picture(const Placement& placement, cv::Point corner, int square, cv::Size picture) {
  const cv::Size reduced = pieces_picture(placement, picture);
  const double x = static_cast<double>(reduced.width) / picture.width,
               y = static_cast<double>(reduced.height) / picture.height;
  // Pixel p of the picture has its middle at (p + 1/2) x - 1/2 of the reduced one.
  const auto offset = [&](double factor, int first) {
    return (factor / 2 - 0.5 - first - (square - 1) / 2.0) / square;
  };
  return {x / square, 0, offset(x, corner.x), 0, y / square, offset(y, corner.y)};
}

double mean_speed(const Placement& placement) {
  double sum = 0;
  for (const PlacedPatch& patch : placement.patches) sum += patch.speed;
  return placement.patches.empty() ? 1 : sum / static_cast<double>(placement.patches.size());
}

}  // namespace freshet::synth::animate
