// synth/stills/sampling.h — a sequence of stills of any length, drawn so that it goes as the paths go.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "synth/stills/partial_order.h"
#include "synth/stills/still_graph.h"

namespace freshet::synth::stills {

struct SamplingOptions {
  int steps = 20;      // of the sequence: its stills less one; a loop's are about as many
  double sigma = 0.1;  // of Eq. 2: how freely a step departs from the likeliest, above 0
  /// Eq. 2 as printed divides the penalties by their sum over all places, so that twice the paths make the
  /// draw half as sharp; with 60 places and sigma .1 nothing is much likelier than anything else. We divide
  /// by their mean, and sigma keeps its meaning. true: as printed, for measuring.
  bool by_sum = false;
  int order = 2;  // 1: Eq. 1 without its first term, for measuring
  /// Chance that a turn within a path is accepted (Sec. 5.2), 0..1. At a path's end a turn always is.
  double irregularity = 0.2;
  bool loop = false;  // the last still is the first
  bool avoid_dead_ends =
      false;  // branches from which one can only turn back are not walked, where something is left
  std::uint64_t seed = 1;
};

/// What a step from one still to another costs beside Eq. 1, as the sequence's `n`th step (Eq. 3).
using StepCost = std::function<double(int from, int to, int n)>;

/// Stills by number; each follows the one before over an edge of the graph.
/// Source   Lin et al. 2007, Sec. 3.3, Eq. 1 and 2. Three departures. Eq. 1 needs a still before the path's
///          k-th: before
///          its first we set its second, so that a path can be entered at its end: the turn of a pendulum.
///          Where the
///          still that is drawn is no neighbour, the shortest way to it is walked. A loop is the draw of 64
///          that comes
///          back to its first still over the least distance, with about as many steps as asked.
/// paths    not empty. Throws Error{kInput} when no path is left.
std::vector<int> sample_sequence(const StillGraph& graph, const std::vector<Path>& paths,
                                 const SamplingOptions& options = {}, const StepCost& extra = {});

/// What is left of the paths without dead ends; the paths themselves where nothing would be left.
std::vector<Path> without_dead_ends(const std::vector<Path>& paths, int stills);

}  // namespace freshet::synth::stills
