// query/candidates.h — the patches among which each piece of a picture chooses.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "query/candidate_index.h"
#include "query/flann_index.h"
#include "query/patch_table.h"
#include "query/target.h"
#include "store/store.h"

namespace freshet::query {

struct CandidateOptions {
  int k = 100;               // candidates a piece
  std::string class_name{};  // only clips of this class; empty: all
  std::optional<double>
      direction_deg{};  // mean motion, as seen on the screen: 0 right, 90 up, 180 left, 270 down
  double direction_tolerance_deg = 30;        // to either side
  double min_speed_px_per_s = 2.5;            // with a direction: slower patches have none that counts
  double min_duration_s = 0;                  // of a clip
  std::vector<std::string> excluded_clips{};  // by name
  std::optional<FlannKind> flann{};           // nothing: exact search
  FlannOptions flann_options{};               // checks, max_bytes
};

/// "right", "up", "left", "down", "up-left", ... or degrees. Error{kUsage}.
double parse_direction(const std::string& text);

/// What one condition left over.
struct FilterStep {
  std::string what;  // "all", "class water", "direction 270 +- 30 degrees", ...
  std::size_t patches = 0, clips = 0;
};

struct Filtered {
  RowFilter rows{0};
  std::vector<FilterStep> steps;  // in the order in which they were applied; the first is the whole store
  std::vector<std::string>
      too_short;  // names of clips left out by min_duration_s, of those that were still in
};

/// Which rows the options allow, before any search.
/// Throws Error{kNotFound} when none is left, naming the condition that removed the last and what there is;
/// Error{kUsage} for a number out of range.
Filtered filter_rows(const store::Snapshot& snapshot, const PatchTable& table,
                     const CandidateOptions& options);

/// The index that the options ask for: exact, built here from the words, or FLANN's from the store.
/// Throws Error{kNotFound} "run freshet index --flann ..." when the store has no such index.
std::unique_ptr<CandidateIndex> open_index(const store::Snapshot& snapshot, const PatchTable& table,
                                           int word_count, const CandidateOptions& options);

/// Candidates of all pieces, best first; rows beyond a piece's count are kNoRow.
struct Candidates {
  std::size_t k = 0;
  std::vector<Row> rows;              // pieces * k
  std::vector<float> scores;          // pieces * k: intersection / mass of the piece, 0..1
  std::vector<std::uint32_t> counts;  // of each piece, 1..k
  std::vector<std::string> notes;     // for a person: "12 pieces have fewer than 100 candidates"

  std::size_t pieces() const { return counts.size(); }
  std::span<const Row> rows_of(std::size_t piece) const {
    return std::span(rows).subspan(piece * k, counts[piece]);
  }
  std::span<const float> scores_of(std::size_t piece) const {
    return std::span(scores).subspan(piece * k, counts[piece]);
  }
};

/// Throws Error{kNotFound} when an approximate index finds nothing allowed for a piece.
Candidates find_candidates(const CandidateIndex& index, std::span<const PieceQuery> queries, std::size_t k,
                           const RowFilter& filter);

}  // namespace freshet::query
