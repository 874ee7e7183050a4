// query/search/coherent_candidates.h — candidates that go on where a neighbour's candidate ends.
#pragma once

#include <cstddef>

#include "query/search/candidates.h"

namespace freshet::query {

/// The row of the patch at (x, y) of a variant of a clip; kNoRow when the table has none there.
/// clip   index into table.clips. Cost: a binary search among the clip's rows.
stored::Row find_patch(const stored::PatchTable& table, std::uint32_t clip, std::uint8_t variant, int x,
                       int y);

/// Adds to each piece's candidates the patches that continue its neighbours' best ones in their own clip and
/// variant. Laid beside each other these show what the clip showed there, without a seam and at no pairwise
/// cost. A piece by itself rarely finds them among its k best.
///
/// Only allowed rows that move as the piece's guide asks are added; those already in the list are not added
/// twice. The lists grow by 4 * each at most and stay in their order.
///
/// each      how many of a neighbour's candidates, from the best on; 0 adds none.
/// Cost      4 * each intersections per piece, of 1 to 3 microseconds; all threads.
void add_coherent(const stored::PatchTable& table, int word_count, const Target& target,
                  const RowFilter& filter, const MotionGuide& guide, std::size_t each,
                  Candidates& candidates);

}  // namespace freshet::query
