// query/search/coverage.h — how well a store's patches cover what is asked of them.
#pragma once

#include <vector>

#include "query/index/search_base.h"
#include "query/search/candidates.h"

namespace freshet::query {

/// How like patches are to the best of other clips: intersection / max_score, 0..1.
struct Likeness {
  std::vector<double> clips;  // mean of a clip's patches; -1: there is no other clip, or it has none
  double unlike = 0;  // nine in ten of all patches are more like: what is below looks like nothing there
};

/// Of up to 24 patches of each clip, evenly drawn from its rows. Cost: a search of as many pieces a clip.
Likeness likeness_between_clips(const SearchBase& base);

/// Share of the pieces whose best candidate is less like than `unlike`, 0..1.
double unlike_share(const Candidates& candidates, double unlike);

}  // namespace freshet::query
