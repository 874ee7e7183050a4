// query/flann_index.h — approximate candidate search by FLANN, for comparison with the exact index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "query/candidate_index.h"

namespace freshet::query {

enum class FlannKind { kKdTree, kKMeans, kHierarchical };
FlannKind parse_flann_kind(const std::string& name);  // "kdtree", "kmeans", "hierarchical"; Error{kUsage}
const char* name_of(FlannKind kind);
std::string blob_name(FlannKind kind);  // "flann-kdtree", ...

struct FlannOptions {
  FlannKind kind = FlannKind::kKdTree;
  int trees = 8;                                 // of kdtree; hierarchical takes half as many
  int branching = 32;                            // of kmeans and hierarchical
  int iterations = 5;                            // of kmeans
  int checks = 4096;                             // leaves visited a query: recall for time
  std::size_t max_bytes = std::size_t{4} << 30;  // of the dense histograms: rows * 21 * words bytes
};

/// FLANN under L1 over dense histograms: a byte a bin, weighted 1, 1, 2 by level.
/// All histograms of a store have the mass 324, so that for a query of mass m, |q - h|_1 = m + 324 - 2 I(q,
/// h): the nearest by L1 is the best by intersection, and this holds for a masked query too (m < 324),
/// because the mass of the query is the same for all rows. FLANN's own HistIntersectionDistance finds the
/// least alike: never used. Scores are exact; what is approximate is which rows are found. A filter is
/// applied to a longer answer, as FLANN knows none: few allowed rows mean poor recall. At 246,477 rows: 1 GB,
/// recall@100 0.2-0.7 at 2048 checks. One thread builds; FLANN is not reproducible even when seeded, so
/// neither is an answer from one build to another.
class FlannIndex final : public CandidateIndex {
 public:
  /// Builds. Throws Error{kUsage} when the histograms exceed max_bytes, Error{kDamaged} for words out of
  /// range.
  FlannIndex(std::span<const vision::WordMap> words, int word_count, const FlannOptions& options = {});
  /// Loads what serialize() gave, for the same words: histograms are derived from them again. FLANN trusts
  /// what it reads, so the bytes are hashed first: Error{kDamaged} when they, or the words they were built
  /// for, differ.
  FlannIndex(std::span<const vision::WordMap> words, int word_count, std::span<const std::byte> bytes,
             const FlannOptions& options = {});
  ~FlannIndex() override;

  std::vector<std::byte> serialize() const;
  std::size_t rows() const override;
  std::vector<std::vector<Hit>> search(std::span<const PieceQuery> queries, std::size_t k,
                                       const Admission& admission = {}) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::query
