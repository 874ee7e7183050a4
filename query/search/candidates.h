// query/search/candidates.h — the patches among which each piece of a picture chooses.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "query/index/candidate_index.h"
#include "query/search/motion_guide.h"
#include "query/search/target.h"
#include "store/store.h"
#include "stored/patch_table.h"

namespace freshet::query {

/// As a class: all of them. A store's own class of that name cannot be asked for.
inline constexpr std::string_view kAnyClass = "any";

struct CandidateOptions {
  int k = 100;               // candidates per piece
  std::string class_name{};  // only clips of this class; empty or kAnyClass: all
  /// Mean motion, as seen on the screen: 0 right, 90 up, 180 left, 270 down. Nothing: any.
  std::optional<double> direction_deg{};
  double direction_tolerance_deg = 30;           // to either side
  double min_speed_px_per_s = 2.5;               // with a direction: slower patches have none that counts
  double min_duration_s = 0;                     // of a clip
  double min_scale = 0, max_rotation_deg = 180;  // of a variant
  std::vector<std::string> excluded_clips{};     // by name
  /// The best so many of each neighbour, whose continuations join a piece's candidates (add_coherent).
  int coherent = 10;
  /// Where a guide's demands are a price (GuideCosts), so many times k patches are found by their looks, and the k
  /// stay that are best when they have paid.
  int considered = 3;
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
  /// Names of clips left out by min_duration_s, of those that were still in.
  std::vector<std::string> too_short;
};

/// Throws Error{kNotFound} for a class or an excluded clip that the store does not have, with the one that is most
/// like it. Reads the clips' records alone: for the moment before long work.
void check_names(const store::Snapshot& snapshot, const CandidateOptions& options);

/// Which rows the options allow, before any search.
/// variants   settings.variants().
/// Throws as check_names, Error{kNotFound} when none is left, naming the condition that removed the last and what there
/// is; Error{kUsage} for a number out of range.
Filtered filter_rows(const store::Snapshot& snapshot, const stored::PatchTable& table,
                     std::span<const vision::Variant> variants, const CandidateOptions& options);

/// Candidates of all pieces, best first; rows beyond a piece's count are kNoRow.
struct Candidates {
  std::size_t k = 0;
  std::vector<stored::Row> rows;      // pieces * k
  std::vector<float> scores;          // pieces * k: intersection / max_score of the piece, 0..1
  std::vector<std::uint32_t> counts;  // of each piece, 1..k
  std::vector<PieceMotion> asked;     // of each piece, by a guide; empty: nothing was asked
  std::vector<int> opened;  // of each piece, with `asked`: how many times its tolerances were opened
  /// Of each candidate (steadiness.h), as scores; empty: no direction is asked.
  std::vector<float> steadiness;
  std::vector<std::string> notes;  // for a person: "12 pieces have fewer than 100 candidates"

  std::size_t pieces() const { return counts.size(); }
  std::span<const stored::Row> rows_of(std::size_t piece) const {
    return std::span(rows).subspan(piece * k, counts[piece]);
  }
  std::span<const float> scores_of(std::size_t piece) const {
    return std::span(scores).subspan(piece * k, counts[piece]);
  }
  std::span<const float> steadiness_of(std::size_t piece) const {
    return steadiness.empty() ? std::span<const float>()
                              : std::span(steadiness).subspan(piece * k, counts[piece]);
  }
};

/// What the search found for one piece, before its neighbours' continuations join.
struct PieceAnswer {
  std::vector<ScoredPatch> scored_patches;
  int opened = 0;  // how many times the piece's tolerances were opened
  bool operator==(const PieceAnswer&) const = default;
};

/// The k best of each piece among the allowed rows that move as its guide asks. Where fewer than k do, the
/// guide's tolerances open step by step for that piece alone (window_of), until there are k or nothing of the
/// guide is left; `opened` and a note say where.
/// guide     may be empty.
/// matte     see asked_motion.
/// answers   one per piece, or null: those that are there are taken, the rest is searched and filled in.
/// Throws    Error{kNotFound} when an approximate index finds nothing allowed for a piece.
Candidates find_candidates(const CandidateIndex& index, const stored::PatchTable& table, const Target& target,
                           const cv::Mat& matte, std::size_t k, const RowFilter& filter,
                           const MotionGuide& guide = {},
                           std::vector<std::optional<PieceAnswer>>* answers = nullptr);

}  // namespace freshet::query
