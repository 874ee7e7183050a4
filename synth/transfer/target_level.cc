#include "synth/transfer/target_level.h"

#include <algorithm>
#include <utility>

namespace freshet::synth::transfer {
namespace {

// The margin repeats the edge.
template <typename T>
GridOf<T> with_margin(const GridOf<T>& grid, int margin) {
  GridOf<T> out(grid.width + 2 * margin, grid.height + 2 * margin);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out(x, y) = grid(std::clamp(x - margin, 0, grid.width - 1), std::clamp(y - margin, 0, grid.height - 1));
  return out;
}

}  // namespace

std::vector<TargetLevel> target_levels(Grid blurred_alpha, Guides guides, Past past, std::size_t levels,
                                       const TransferOptions& options) {
  const int margin = options.patch / 2;
  std::vector<TargetLevel> made;
  for (std::size_t k = 0; k < levels; ++k) {
    if (k > 0) {
      blurred_alpha = halved(blurred_alpha);
      past.picture = halved(past.picture);
      past.lambda = halved(past.lambda);
      if (guided(options)) guides = {halved(guides.curvature), halved(guides.divergence)};
    }
    TargetLevel level;
    level.blurred_alpha = with_margin(blurred_alpha, margin);
    level.lambda = with_margin(past.lambda, margin);
    level.previous = with_margin(past.picture, margin);
    segment(level.blurred_alpha, options.lower, options.upper, margin, level.segments);
    level.features = Features(level.previous.width, level.previous.height);
    put_blurred_alpha(level.blurred_alpha, options.eta, level.features);
    put_previous(level.previous, level.features);
    if (guided(options))
      put_guides({with_margin(guides.curvature, margin), with_margin(guides.divergence, margin)}, options,
                 level.features);
    made.push_back(std::move(level));
  }
  return made;
}

}  // namespace freshet::synth::transfer
