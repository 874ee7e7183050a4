// query/index/flann_index.h — approximate candidate search by FLANN, which a store holds beside the exact index.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "query/index/candidate_index.h"

namespace freshet::query {

enum class FlannKind { kKdTree, kKMeans, kHierarchical };
FlannKind parse_flann_kind(const std::string& name);  // "kdtree", "kmeans", "hierarchical"; Error{kUsage}
const char* name_of(FlannKind kind);
std::string blob_name(FlannKind kind);  // "flann-kdtree", ...

struct FlannOptions {
  FlannKind kind = FlannKind::kKdTree;
  int trees = 8;           // of kdtree; hierarchical takes half as many
  int branching = 32;      // of kmeans and hierarchical
  int iterations = 5;      // of kmeans
  std::uint32_t seed = 1;  // the same seed, words and options: the same trees
  int checks = 0;  // patches looked at for a query: more find more, slower. 0: what the index was tuned to
  std::size_t max_bytes = std::size_t{4} << 30;  // of the dense histograms: rows * 21 * words bytes
};
inline constexpr int kUntunedChecks = 4096;

/// What is known of an index and kept with it.
struct FlannTuning {
  float build_seconds = 0;   // of one thread
  std::uint32_t checks = 0;  // that reach `recall`; 0: not tuned (tune_flann)
  float recall = 0;          // recall@100 that was reached with them
};

/// FLANN under L1 over dense histograms: a byte per bin, weighted 1, 1, 2 by level.
///
/// All patches of a store have the max_score 324, so that the nearest by L1 is the best by intersection
/// (dense_histogram.h). FLANN's own HistIntersectionDistance finds the least alike: never used. Scores are
/// exact; what is approximate is which rows are found. Conditions hold inside FLANN's search: it looks at as
/// many more patches as are not admitted, and goes on until k admitted ones are found or none is left.
///
/// One thread builds. FLANN 1.9.2 by itself draws its trees from std::random_device: seeding it does not make
/// it reproducible. Here it draws from `seed`, so that the bytes are the same too, except for kdtree: FLANN
/// writes a number of its leaves that it neither sets nor reads.
class FlannIndex final : public CandidateIndex {
 public:
  /// Builds. Throws Error{kUsage} when the histograms exceed max_bytes, Error{kDamaged} for words
  /// out of range.
  FlannIndex(vision::WordMaps words, int word_count, const FlannOptions& options = {});
  /// Loads what serialize() gave, for the same words: histograms are derived from them again. The bytes may be
  /// anybody's: they are walked before FLANN gets them (flann_trees.h). Error{kDamaged} when they are no such trees, or
  /// when they were built for other words.
  FlannIndex(vision::WordMaps words, int word_count, std::span<const std::byte> bytes,
             const FlannOptions& options = {});
  ~FlannIndex() override;

  std::vector<std::byte> serialize() const;
  /// What serialize() keeps beside the index.
  const FlannTuning& tuning() const;
  void set_tuning(std::uint32_t checks, float recall);
  /// As options.checks; not while a search runs.
  void set_checks(int checks);
  std::size_t rows() const override;
  std::vector<std::vector<ScoredPatch>> search(std::span<const PieceQuery> queries, std::size_t k,
                                               const SearchFilter& search_filter = {}) const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::query
