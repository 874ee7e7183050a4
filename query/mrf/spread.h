// query/mrf/spread.h — an energy minimised so that no group of labels takes most of the nodes.
#pragma once

#include <cstdint>
#include <span>

#include "query/mrf/minimizer.h"
#include "query/mrf/mrf.h"

namespace freshet::query {

/// Minimises; then, at most four times, while the labels of more than half of at least 20 nodes are of one group, adds
/// `price` to all labels of that group and minimises again. Nodes that have no label of another group which costs as
/// little keep theirs; where no label changes, nothing is priced.
/// groups    of each label, as mrf.unary: 0 to a few hundred (the clip that a candidate is of).
/// price     0: one minimisation.
/// mrf       with all other costs; the prices are added to it.
/// Returns   the last labels, with the energy and the bound of the field with its prices: the gap says how far
///           these labels can be from the best under those prices, not whether others would have been paid less.
///           Iterations of all rounds.
Solution minimize_spread(std::span<const std::uint32_t> groups, double price, Minimizer minimizer,
                         int max_iterations, Mrf& mrf);

}  // namespace freshet::query
