// query/benchmark/search_benchmark.h — every index measured on one store, with the same questions.
#pragma once

#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "query/benchmark/benchmark_pieces.h"
#include "query/benchmark/measured_index.h"
#include "query/benchmark/search_report.h"

namespace freshet::query {

struct SearchBenchmarkOptions {
  std::size_t rows = 0;      // searched among, evenly spread over the store; 0: all
  std::size_t pieces = 200;  // asked, at most
  /// Of one core, for one index. An index that would take longer is built of fewer rows.
  double build_limit_s = 60;
  std::size_t min_rows = 1000;  // that an index is built of; limits hold for eight times as many and more
  /// Of one core, for one setting: then no more pieces are asked, but 10 are in any case.
  double setting_limit_s = 5;
  std::size_t checked = 3;            // pieces whose exact answer is compared with brute force
  bool label = true;                  // the first picture, with the candidates of every setting
  std::size_t labelled_pieces = 250;  // of that picture, around the middle of its matte
  double label_limit_s = 30;  // for its search alone; a setting that would take longer is not labelled
  bool filters = true;
  /// Of an index, and while it is built. 0: four fifths of what the machine has free.
  std::size_t max_bytes = 0;
};

/// Measures the indexes in turn; each is gone before the next is built.
///
/// Recall is against ExactIndex over the same rows, itself compared with brute force. Whether an index would
/// pass the limits is estimated by building it of a 32nd and an 8th of the rows. Loss of energy: the picture
/// is labelled with the index's candidates as query::label does it, but without the candidates' vote, which
/// is a cost that depends on the candidates; so one energy judges all.
/// base       its index is replaced while a picture is labelled, and back in its place afterwards, also when this
///            throws.
/// progress   called from the calling thread; may be empty.
/// Throws     Error{kCancelled} when stopped, Error{kUsage} for more rows than there are. What an index
///            throws is the reason why it has no result.
SearchReport benchmark_search(const store::Snapshot& snapshot, SearchBase& base,
                              std::vector<BenchmarkPicture> pictures, std::span<const MeasuredIndex> indexes,
                              const SearchBenchmarkOptions& options = {},
                              const std::function<void(const std::string&)>& progress = {},
                              std::stop_token stop = {});

/// Recall of answers whose rows are scored anew. Both as CandidateIndex::search gives them, best first.
Recall recall_of(std::span<const std::vector<ScoredPatch>> found,
                 std::span<const std::vector<ScoredPatch>> exact, std::span<const PieceQuery> queries,
                 const SearchSpace& space);

}  // namespace freshet::query
