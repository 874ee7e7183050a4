#include "synth/matte/proposal.h"

#include <algorithm>
#include <vector>

namespace freshet::synth::matte {
namespace {

// The mean over a piece and its neighbours on the lattice, as far as there are any.
std::vector<double> smoothed(const query::Target& target, const std::vector<double>& scores) {
  const int columns = target.columns, rows = target.rows;
  std::vector<int> piece_at(static_cast<std::size_t>(columns * rows), -1);
  for (std::size_t piece = 0; piece < target.size(); ++piece)
    piece_at[static_cast<std::size_t>(target.places[piece].y * columns + target.places[piece].x)] =
        static_cast<int>(piece);
  std::vector<double> out(scores.size());
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    double sum = 0, count = 0;
    for (int y = std::max(0, target.places[piece].y - 1); y <= std::min(rows - 1, target.places[piece].y + 1);
         ++y)
      for (int x = std::max(0, target.places[piece].x - 1);
           x <= std::min(columns - 1, target.places[piece].x + 1); ++x)
        if (const int other = piece_at[static_cast<std::size_t>(y * columns + x)]; other >= 0) {
          sum += scores[static_cast<std::size_t>(other)];
          ++count;
        }
    out[piece] = sum / count;
  }
  return out;
}

struct Split {
  double lower = 0, upper = 0;  // means of the two sides
};

// Otsu: of all splits of the sorted values, the one with most variance between its sides.
Split split(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  double total = 0, below = 0, best = -1;
  for (const double value : values) total += value;
  Split out;
  for (std::size_t i = 1; i < values.size(); ++i) {
    below += values[i - 1];
    const double count = static_cast<double>(i), rest = static_cast<double>(values.size() - i);
    const double lower = below / count, upper = (total - below) / rest;
    const double between = count * rest * (upper - lower) * (upper - lower);
    if (between > best) {
      best = between;
      out = {lower, upper};
    }
  }
  return out;
}

}  // namespace

Proposal propose_marks(const query::Target& target, const query::Candidates& candidates,
                       const ProposalOptions& options) {
  std::vector<double> scores(target.size(), 0);
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const auto found = candidates.scores_of(piece);
    const std::size_t count = std::min(found.size(), static_cast<std::size_t>(options.best));
    for (std::size_t i = 0; i < count; ++i) scores[piece] += found[i] / static_cast<double>(count);
  }
  scores = smoothed(target, scores);
  const Split sides = split(scores);
  Proposal proposal;
  proposal.fluid_score = sides.upper;
  proposal.background_score = sides.lower;
  proposal.marks = Marks(target.picture, CV_8U, cv::Scalar(kUnknown));
  proposal.stands_out = sides.upper - sides.lower >= options.min_difference;
  if (!proposal.stands_out) return proposal;
  const cv::Rect picture({}, target.picture);
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const bool fluid = scores[piece] >= sides.upper;
    if (!fluid && scores[piece] > sides.lower) continue;
    const cv::Rect middle(target.corners[piece].x + target.side / 4,
                          target.corners[piece].y + target.side / 4, target.side / 2, target.side / 2);
    proposal.marks(middle & picture).setTo(fluid ? kFluid : kBackground);
    ++(fluid ? proposal.fluid_pieces : proposal.background_pieces);
  }
  return proposal;
}

}  // namespace freshet::synth::matte
