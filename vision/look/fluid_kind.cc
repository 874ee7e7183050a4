#include "vision/look/fluid_kind.h"

#include <algorithm>
#include <cmath>

#include "vision/look/kind_weights.h"

namespace freshet::vision {
namespace {

consteval bool names_match() {
  for (std::size_t i = 0; i < kLookFigures.size(); ++i)
    if (kKindWeights[i].figure != kLookFigures[i]) return false;
  return kKindWeights.size() == kLookFigures.size();
}
/// At build: a figure that is gone is no constant.
consteval std::size_t index_of(std::string_view figure) {
  for (std::size_t i = 0; i < kLookFigures.size(); ++i)
    if (kLookFigures[i] == figure) return i;
  throw "no such figure";
}
/// Detail, as the figure has it, of a contrast below a fifth of a grey level: nothing is seen. The
/// faintest that was learned from, smoke in the dark, has three times as much.
constexpr double kFaintest = -5.88;

static_assert(names_match(),
              "the figures of the look changed: make kind_weights.h again (bench_kind --weights)");

}  // namespace

FluidKind fluid_kind(const FluidLook& look) {
  std::array<double, kFluidKinds.size()> score{};
  for (std::size_t kind = 0; kind < score.size(); ++kind) score[kind] = kKindOffsets[kind];
  for (std::size_t i = 0; i < look.size(); ++i) {
    const FigureWeights& w = kKindWeights[i];
    const double deviations = std::clamp((look[i] - w.mean) / w.deviation, -kFarthest, kFarthest);
    for (std::size_t kind = 0; kind < score.size(); ++kind) score[kind] += deviations * w.speaks_for[kind];
  }
  if (look[index_of("detail")] < kFaintest) score.fill(0);
  const auto best = std::ranges::max_element(score);
  FluidKind kind{.best = static_cast<int>(best - score.begin())};
  double sum = 0;
  for (std::size_t k = 0; k < score.size(); ++k) sum += kind.share[k] = std::exp(score[k] - *best);
  for (double& share : kind.share) share /= sum;
  return kind;
}

}  // namespace freshet::vision
