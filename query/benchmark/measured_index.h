// query/benchmark/measured_index.h — what freshet query bench asks of an index that it measures.
//
// To add one: write a file beside this one with a function that returns a MeasuredIndex, and name
// it in measured_indexes.cc and CMakeLists.txt. measured_scan.cc is a whole example;
// docs/benchmark.md walks through it.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "query/index/candidate_index.h"
#include "store/store.h"

namespace freshet::query {

/// The patches to search among: row i is words[i]. Outlives the index that is built of it.
struct SearchSpace {
  vision::WordMaps words;  // each below word_count
  int word_count = 0;
};

/// A name for the table ("ef 200") and what makes the index search so from then on. Never called
/// while a search runs.
struct IndexSetting {
  std::string name;
  std::function<void()> apply;
};

struct BuiltIndex {
  std::shared_ptr<const CandidateIndex> index;
  std::vector<IndexSetting> settings;        // from fast to thorough; at least one
  std::optional<double> build_seconds = {};  // of an index that was loaded; else it is measured
};

/// An index as the benchmark knows it. Answers are judged by the rows that they name: their scores are
/// computed again, and recall counts a row that scores as well as the k-th of the exact answer.
struct MeasuredIndex {
  std::string name;       // on the command line, and of the curve: "hnswlib"
  std::string what;       // for a person: parameters, distance, "exact"
  std::string package{};  // Debian's, without which Freshet was built when `build` is empty
  bool is_exact = false;
  /// On the calling thread, with TBB held to one; the benchmark measures its time and its bytes.
  /// Throws Error where it cannot.
  std::function<BuiltIndex(const SearchSpace&)> build = {};
  /// One that the store keeps, for all of its patches; nothing when it keeps none. May be empty.
  std::function<std::optional<BuiltIndex>(const SearchSpace&, const store::Snapshot&)> load = {};
};

/// Answers each query by `one(query, number)`, on all threads.
std::vector<std::vector<ScoredPatch>> search_each(
    std::span<const PieceQuery> queries,
    const std::function<std::vector<ScoredPatch>(const PieceQuery&, std::size_t)>& one);

/// For an index that knows no conditions: asks it for more than k rows, then for four times as many, until k
/// of what it gives are admitted or it has given all rows.
/// ask    the best `count` rows of the query, any order, scored.
std::vector<ScoredPatch> search_widening(
    std::size_t rows, std::size_t k, const SearchFilter& search_filter, std::size_t query_number,
    const std::function<std::vector<ScoredPatch>(std::size_t count)>& ask);

}  // namespace freshet::query
