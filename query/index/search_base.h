// query/index/search_base.h — what a search needs of a store, opened once for many pictures and settings.
#pragma once

#include <memory>
#include <optional>

#include "query/index/candidate_index.h"
#include "query/index/flann_index.h"
#include "store/store.h"
#include "stored/patch_table.h"
#include "vision/codebook.h"
#include "vision/settings.h"

namespace freshet::query {

/// All of it is derived from one snapshot and does not change. Safe from many threads.
struct SearchBase {
  vision::Settings settings;
  vision::Codebook codebook;
  stored::PatchTable table;
  std::unique_ptr<const CandidateIndex> index;
  bool is_exact = true;  // the index: its answers depend on words and rows alone
  double seconds = 0;    // that opening took
};

/// Which index answers: the exact one, built here from the words, or one of FLANN's from the store.
struct IndexChoice {
  std::optional<FlannKind> flann{};  // nothing: exact search
  FlannOptions flann_options{};      // checks, max_bytes
  bool built_late = false;           // the exact index is built by the first search that needs it
};

/// Throws as read_codebook and read_patch_table; Error{kNotFound} "run freshet index --flann ..." when the
/// store has no such index. Cost: 1.6 us of CPU and 620 bytes per patch, exact; 81 bytes more with over 256 words.
SearchBase open_search(const store::Snapshot& snapshot, const IndexChoice& choice = {});

}  // namespace freshet::query
