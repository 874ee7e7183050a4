// synth/stills/partial_order.h — orders of some of the stills in which the scene may have gone through them.
#pragma once

#include <vector>

#include "synth/stills/still_graph.h"

namespace freshet::synth::stills {

/// Stills as they follow each other, at least two.
using Path = std::vector<int>;

/// From every still the shortest way to the one farthest from it, forth and back; of equal ones the first.
/// Ways that are part of another are left out. Among equally far stills the one with the lowest number is
/// taken. Where the graph falls apart, of its largest part alone.
/// Source   Lin et al. 2007, Sec. 3.2.
std::vector<Path> extremal_paths(const StillGraph& graph);

/// Without paths that are part of another, in either case the first of equals stays.
std::vector<Path> without_contained(const std::vector<Path>& paths);
bool is_part_of(const Path& part, const Path& whole);
Path reversed(const Path& path);

}  // namespace freshet::synth::stills
