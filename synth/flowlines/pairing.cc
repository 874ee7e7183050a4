#include "synth/flowlines/pairing.h"

#include <cstddef>
#include <limits>

namespace freshet::synth::flowlines {

std::vector<int> pair_lines(int lines, int inputs,
                            const std::function<double(int x, int before, int y)>& error,
                            const std::vector<int>& given) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  const auto n = static_cast<std::size_t>(inputs);
  const auto allowed = [&](int x, int y) {
    const int chosen = given.empty() ? -1 : given[static_cast<std::size_t>(x)];
    return chosen < 0 || chosen == y;
  };
  std::vector<double> cost(n);
  for (int y = 0; y < inputs; ++y) cost[static_cast<std::size_t>(y)] = allowed(0, y) ? 0 : kNever;
  std::vector<std::vector<int>> before(static_cast<std::size_t>(lines), std::vector<int>(n, 0));
  std::vector<double> next(n);
  for (int x = 1; x < lines; ++x) {
    for (int y = 0; y < inputs; ++y) {
      double& least = next[static_cast<std::size_t>(y)];
      least = kNever;
      if (!allowed(x, y)) continue;
      for (int y0 = 0; y0 < inputs; ++y0) {
        if (cost[static_cast<std::size_t>(y0)] == kNever) continue;
        const double sum = cost[static_cast<std::size_t>(y0)] + error(x, y0, y);
        if (sum >= least) continue;
        least = sum;
        before[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)] = y0;
      }
    }
    cost.swap(next);
  }
  std::vector<int> chosen(static_cast<std::size_t>(lines));
  int best = 0;
  for (int y = 1; y < inputs; ++y)
    if (cost[static_cast<std::size_t>(y)] < cost[static_cast<std::size_t>(best)]) best = y;
  for (int x = lines - 1; x >= 0; --x) {
    chosen[static_cast<std::size_t>(x)] = best;
    best = before[static_cast<std::size_t>(x)][static_cast<std::size_t>(best)];
  }
  return chosen;
}

}  // namespace freshet::synth::flowlines
