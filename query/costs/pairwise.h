// query/costs/pairwise.h — how well patches of neighbouring pieces go together: the energy of a labelling.
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "query/mrf/mrf.h"
#include "query/search/candidates.h"
#include "query/search/target.h"

namespace freshet::query {

enum class CostForm {
  kLog,    // distances of logarithms: relative to size
  kPower,  // distances of raw power, as in the paper
};
CostForm parse_cost_form(const std::string& name);  // "log", "power"; Error{kUsage}
const char* name_of(CostForm form);

/// W = lambda * (motion + sigma * dynamics + rho * textureness), each a mean over the cells of the overlap:
/// squared distance of mean motion, of power by band (both components, all bands), of textureness by level.
///
/// kPower is Eq. 2, 3 and 6 of the paper: motion in px per frame at 25 frames per second, power in its
/// square, textureness in 0..1, with the paper's parameters. It is small between any two quiet patches and
/// large between any two lively ones. So a labelling drifts to faint, slow motion: speeds halve on water.
///
/// kLog compares logarithms, which are zero where features agree, whatever their strength:
///   motion        log(1 + speed / 2.5 px/s), in the direction of motion
///   dynamics      log of amplitude: half the log of power, above 1 px/s
///   textureness   its log, above 1/512
/// sigma and rho make means over 8 bands and 4 levels. lambda was set on a waterfall of 274 pieces: by
/// likeness alone 45 % of neighbours share a clip. With 0.01 it is 84 %, at 3 % more unary cost; with 0.05 it
/// is 86 %, at nearly twice that.
///
/// Both forms still drift to calm motion, as the quietest patches fit each other best: a fire of 98 px/s by
/// likeness alone had 43 when labelled. The vote works against it. What looks like a piece tells how strongly
/// the piece moves. A candidate's strength is the root of its W beside a patch that stands still; it pays
/// vote * (its strength - the median of the piece's candidates)^2. A vote of 4 brings that fire to 60 px/s
/// (docs/measurements/animation.md). Without lambda or overlap nothing drifts, and there is no vote.
struct PairwiseOptions {
  CostForm form = CostForm::kLog;
  double lambda = 0.01, sigma = 0.125, rho = 0.25;
  double vote = 4;  // of a piece's candidates on how strongly it moves; 0: none, as in the paper
};
/// The defaults of each form; kPower: lambda 0.01, sigma 100, rho 100 * sigma.
PairwiseOptions default_costs(CostForm form);

/// The shape of what vision::patch_features gives.
struct FeatureShape {
  int cells = 12;  // on a patch's side
  int bands = 8;
  int overlap = 6;  // cells that neighbours share, across
  int channels() const;
  std::size_t values() const;  // of a patch
  /// Cells on the side of a square: of the largest squares of which both a patch and an overlap consist.
  int square() const;
  int squares() const { return cells / square(); }
  std::size_t square_values() const;
};
/// Throws Error{kUsage} when neighbouring pieces do not share whole cells.
FeatureShape feature_shape(const vision::Settings& settings);

/// A square of cells, shape.square() on a side, in a variant of a clip. Patches that overlap share squares:
/// each is read once, and its features serve all of them.
struct Square {
  std::uint32_t clip = 0;
  std::uint8_t variant = 0;
  std::uint16_t y = 0, x = 0;  // px, of its upper left corner in the variant's frame
  auto operator<=>(const Square&) const = default;
};

/// Takes the features of a square, by its place among those that were asked for: shape.square_values() of
/// them, as vision::patch_features lays them out. Called from many threads.
using SquareSink = std::function<void(std::size_t place, std::span<const float> features)>;

/// Where features come from.
struct FeatureSource {
  /// The squares of a patch, shape.squares() on a side, row by row. Called from many threads.
  std::function<void(stored::Row, std::span<Square>)> squares;
  /// Hands over the features of squares (ascending, distinct), each once, in any order.
  std::function<void(std::span<const Square>, const SquareSink&)> read;
};

/// Throws Error{kUsage} when a weight is negative, no number or above 1e9.
void check_weights(const PairwiseOptions& options);

/// A field's nodes in the order of the pieces, V = 1 - score, and its edges in that of target.edges. The
/// tables are all zero.
Mrf unconnected_field(const Target& target, const Candidates& candidates);

/// The field of a picture: nodes in the order of its pieces, V = 1 - score; edges in the order of
/// target.edges. The parts that it weighs and adds are those of pairwise_parts.h: the same bits as when they
/// are kept and combined. All threads; the same bits for any number.
///
/// Memory   512 MB for the candidates' features: where they do not fit, they are read in batches of rows of
///          pieces.
/// Cost     500 pieces of 120 candidates: 1.0 to 1.7 s of CPU.
/// Throws   Error{kCancelled} when stopped, and as check_weights.
Mrf build_mrf(const Target& target, const Candidates& candidates, const FeatureShape& shape,
              const PairwiseOptions& options, const FeatureSource& source, std::stop_token stop = {});

}  // namespace freshet::query
