// query/labelling/labelling_memo.h — the memo of labellings: what an earlier one has computed already.
//
// After a changed stroke only the pieces whose candidates it changes are searched, and only their edges are
// compared again; the rest comes from a LabelCache. Each result is found by a hash of everything that it
// depends on: the store's patches, codebook, settings and sources, and
//   a piece's candidates      its words, the rows that filters leave, k, and the window of motion asked there
//   a piece's strength        its candidates and their neighbours' continuations, the form of costs
//   an edge's table           the candidates of both, lambda, sigma, rho and the form of costs
//   the labels                all of these, the unary costs' weights and the solver
// so that the labels are those of a labelling without a cache, bit for bit.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "cache/result_cache.h"
#include "query/costs/guide_costs.h"
#include "query/costs/pairwise.h"
#include "query/costs/reuse.h"
#include "query/index/search_base.h"
#include "query/mrf/minimizer.h"
#include "query/search/candidates.h"
#include "store/store.h"

namespace freshet::query {

/// How much was there.
struct Reuse {
  std::size_t pieces = 0, edges = 0;                // of the picture
  std::size_t reused_pieces = 0, reused_edges = 0;  // whose candidates, whose tables
  bool labels = false;                              // no table was needed, nor a solver
};
/// "487 of 512 pieces' candidates and 890 of 955 edges reused", for a person.
std::string to_string(const Reuse& reuse);

/// The view that labellings of one snapshot have of a cache. Borrows the cache and the base. One thread.
class LabellingMemo {
 public:
  /// Cost: 10 ms for 357,650 patches. Answers of an approximate index are neither looked up nor kept: its
  /// bytes are not part of what is hashed.
  LabellingMemo(cache::ResultCache& cache, const store::Snapshot& snapshot, const SearchBase& base);
  LabellingMemo(cache::ResultCache&, const store::Snapshot&, const SearchBase&&) = delete;

  /// As query::find_candidates.
  Candidates find_candidates(const Target& target, const cv::Mat& matte, std::size_t k,
                             const RowFilter& filter, const MotionGuide& guide);
  /// As query::build_mrf.
  Mrf build_mrf(const Target& target, const Candidates& candidates, const FeatureShape& shape,
                const PairwiseOptions& options, const FeatureSource& source, std::stop_token stop);

  /// Of everything that a solution of this field depends on.
  cache::Key solution_key(const Target& target, const Candidates& candidates, const PairwiseOptions& options,
                          const GuideCosts& guide_costs, const ReuseCosts& reuse, Minimizer minimizer,
                          int max_iterations) const;
  std::optional<Solution> find_solution(const cache::Key& key, const Target& target,
                                        const Candidates& candidates);
  void keep_solution(const cache::Key& key, const Solution& solution);

  /// Of the last labelling.
  const Reuse& reuse() const { return reuse_; }

 private:
  cache::Key key_of_candidates(std::span<const stored::Row> rows) const;

  cache::ResultCache& cache_;
  const SearchBase& base_;
  cache::Key identity_;
  Reuse reuse_;
};

}  // namespace freshet::query
