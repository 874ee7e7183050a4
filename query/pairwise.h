// query/pairwise.h — how well the patches of neighbouring pieces go together: the energy of a labelling.
#pragma once

#include <functional>
#include <span>
#include <stop_token>
#include <string>

#include "query/candidates.h"
#include "query/mrf.h"
#include "query/target.h"

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
/// kPower, Eq. 2, 3, 6 of the paper: motion in px a frame at 25 frames a second, power in its square,
/// textureness in 0..1; the paper's parameters. Small between any two quiet patches, large between any two
/// lively ones, so that a labelling drifts to faint, slow motion (speeds halved on water).
///
/// kLog: log(1 + speed / 2.5 px/s) in the direction of motion, log of amplitude (half the log of power, above
/// 1 px/s), log of textureness (above 1/512): zero where looks agree, whatever their strength. sigma and rho
/// make means over 8 bands and 4 levels. lambda: on a waterfall of 274 pieces, with 0.01 84 % of neighbours
/// share a clip (45 % by looks alone) at 3 % more unary cost; 0.05 makes it 86 % and nearly doubles that.
///
/// Both forms still drift to calm motion, as the quietest patches fit each other best (fire 98 px/s by looks
/// alone, 43 when labelled). Against it the candidates vote: what looks like a piece tells how strongly it
/// moves, and a candidate pays vote * (its strength - their median)^2, strength being the root of its W
/// beside a patch that stands still. 4 brings that fire to 60 px/s (docs/measurements.md). Without lambda or
/// overlap there is nothing that drifts, and no vote.
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
};
/// Throws Error{kUsage} when neighbouring pieces do not share whole cells.
FeatureShape feature_shape(const vision::Settings& settings);

/// Where features come from.
struct FeatureSource {
  /// Called before the features of these rows (distinct) are asked for, on one thread; may be empty.
  std::function<void(std::span<const Row>)> prepare;
  /// As vision::patch_features; called from many threads.
  std::function<void(Row, std::span<float>)> read;
};

/// Throws Error{kUsage} when a weight is negative, no number or above 1e9.
void check_weights(const PairwiseOptions& options);

/// A field's nodes in the order of the pieces, V = 1 - score, and its edges in that of target.edges, their
/// tables all zero.
Mrf unconnected_field(const Target& target, const Candidates& candidates);

/// The field of a picture: nodes in the order of its pieces, V = 1 - score; edges in the order of
/// target.edges. Each candidate's features are computed once, piece row by piece row, and two rows of them
/// are in memory (1.3 MB a piece). All threads; the same bits for any number. Cost, 500 pieces, 100
/// candidates: 1-2 s. Throws Error{kCancelled} when stopped, and as check_weights. The parts that it weighs
/// and adds are those of pairwise_parts.h: the same bits as when they are kept and combined.
Mrf build_mrf(const Target& target, const Candidates& candidates, const FeatureShape& shape,
              const PairwiseOptions& options, const FeatureSource& source, std::stop_token stop = {});

}  // namespace freshet::query
