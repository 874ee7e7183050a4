// query/index/flann_tuning.h — how many patches a FLANN index must look at in a store of its own.
#pragma once

#include <span>

#include "query/index/flann_index.h"

namespace freshet::query {

struct FlannTuningOptions {
  double recall = 0.9;  // recall@100, mean of the queries
  std::size_t queries = 40;
};

/// Finds the minimum of checks that reach the recall, to a fifth, and keeps them in the index. Where no
/// number of checks reaches it (kdtree, whose trees end before), all rows are checked.
///
/// Queries are patches of the store, evenly spread. Each is searched among the patches of all other clips, as
/// a picture's pieces are like no clip exactly; with a single clip, among all.
///
/// words       that the index was built for.
/// clip_rows   first row of each clip, and the number of rows at the end.
/// Cost        the queries some ten times; 246,477 patches: seconds.
void tune_flann(FlannIndex& index, vision::WordMaps words, int word_count,
                std::span<const stored::Row> clip_rows, const FlannTuningOptions& options = {});

}  // namespace freshet::query
