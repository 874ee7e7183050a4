#include "query/costs/pairwise_parts.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <memory>
#include <numeric>

#include "freshet/error.h"
#include "query/costs/cell_log_features.h"
#include "query/costs/squared_distances.h"

namespace freshet::query {
namespace {

// What of the picture is wanted, by rows of pieces.
struct Rows {
  std::vector<std::vector<std::uint32_t>> pieces;    // whose candidates' features are needed
  std::vector<std::vector<std::size_t>> edges;       // by the row of q
  std::vector<std::vector<stored::Row>> candidates;  // ascending, distinct
};

Rows lay_rows(const Target& target, const Candidates& candidates, const PartsWanted& wanted) {
  const auto wants = [](const std::vector<bool>& some, std::size_t i) { return some.empty() || some[i]; };
  Rows rows;
  rows.pieces.resize(target.rows);
  rows.edges.resize(target.rows);
  rows.candidates.resize(target.rows);
  std::vector<bool> needed(target.size());
  for (std::size_t piece = 0; piece < target.size(); ++piece) needed[piece] = wants(wanted.pieces, piece);
  for (std::size_t e = 0; e < target.edges.size(); ++e) {
    if (!wants(wanted.edges, e)) continue;
    const auto [p, q] = target.edges[e];
    needed[p] = needed[q] = true;
    rows.edges[target.places[q].y].push_back(e);
  }
  for (std::uint32_t piece = 0; piece < target.size(); ++piece)
    if (needed[piece]) rows.pieces[target.places[piece].y].push_back(piece);
  oneapi::tbb::parallel_for(std::size_t{0}, rows.pieces.size(), [&](std::size_t row) {
    std::vector<stored::Row>& found = rows.candidates[row];
    for (const std::uint32_t piece : rows.pieces[row]) {
      const auto of_piece = candidates.rows_of(piece);
      found.insert(found.end(), of_piece.begin(), of_piece.end());
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
  });
  return rows;
}

template <class T>
std::vector<T> merged(const std::vector<T>& a, const std::vector<T>& b) {
  std::vector<T> both;
  both.reserve(a.size() + b.size());
  std::set_union(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  return both;
}

// Whole numbers for logarithms, floats for raw power.
template <class Value>
class Comparison {
 public:
  Comparison(const Target& target, const Candidates& candidates, const FeatureShape& shape,
             const FeatureSource& source)
      : target_(target),
        candidates_(candidates),
        shape_(shape),
        source_(source),
        channels_(part_channels(shape)),
        cells_(static_cast<std::size_t>(shape.square()) * shape.square()),
        across_(static_cast<std::size_t>(shape.squares())) {}

  /// The squares that the candidates of a row of pieces consist of: ascending, distinct.
  std::vector<Square> squares_of(const std::vector<stored::Row>& rows) const {
    std::vector<Square> squares(rows.size() * across_ * across_);
    for (std::size_t i = 0; i < rows.size(); ++i)
      source_.squares(rows[i], std::span(squares).subspan(i * across_ * across_, across_ * across_));
    std::sort(squares.begin(), squares.end());
    squares.erase(std::unique(squares.begin(), squares.end()), squares.end());
    return squares;
  }

  /// Reads log features of all candidates of some rows of pieces, in place of those that were held.
  void read(std::vector<stored::Row> rows, const std::vector<Square>& squares) {
    rows_ = std::move(rows);
    const std::size_t values = shape_.square_values();
    log_features_ = std::make_unique_for_overwrite<Value[]>(squares.size() * values);
    strengths_.resize(squares.size());
    source_.read(squares, [&](std::size_t square, std::span<const float> features) {
      const std::span<Value> log_features(log_features_.get() + square * values, values);
      find_log_features(shape_, features, log_features);
      const std::size_t motion = cells_ * channels_[kMotion], dynamics = cells_ * channels_[kDynamics];
      strengths_[square] = {sum_of_squares(log_features.first(motion)),
                            sum_of_squares(log_features.subspan(motion, dynamics))};
    });
    places_.resize(rows_.size() * across_ * across_);
    oneapi::tbb::parallel_for(std::size_t{0}, rows_.size(), [&](std::size_t i) {
      thread_local std::vector<Square> own;
      own.resize(across_ * across_);
      source_.squares(rows_[i], own);
      for (std::size_t k = 0; k < own.size(); ++k)
        places_[i * own.size() + k] = static_cast<std::uint32_t>(
            std::lower_bound(squares.begin(), squares.end(), own[k]) - squares.begin());
    });
  }

  struct Scratch {
    Panel<Value> p, q;
    std::vector<const std::uint32_t*> squares_p, squares_q;
    std::vector<float> values[kParts];
  };

  PieceParts piece(std::size_t number, Scratch& own) const {
    auto &motion = own.values[kMotion], &dynamics = own.values[kDynamics];
    motion.clear();
    dynamics.clear();
    const double unit = unit_of_square() / static_cast<double>(shape_.cells * shape_.cells);
    for (const stored::Row row : candidates_.rows_of(number)) {
      const std::uint32_t* squares = squares_of_row(row);
      double sums[2] = {0, 0};
      for (std::size_t k = 0; k < across_ * across_; ++k)
        for (int part = 0; part < 2; ++part) sums[part] += strengths_[squares[k]][part];
      motion.push_back(static_cast<float>(unit * sums[0]));
      dynamics.push_back(static_cast<float>(unit * sums[1]));
    }
    return {motion, dynamics};
  }

  EdgeParts edge(std::size_t number, Scratch& own) const {
    const auto [p, q] = target_.edges[number];
    const bool beside = target_.places[p].y == target_.places[q].y;
    find_squares(p, own.squares_p);
    find_squares(q, own.squares_q);
    const float unit =
        static_cast<float>(unit_of_square() / static_cast<double>(shape_.overlap * shape_.cells));
    std::size_t first = 0;  // of the part in a square's log features
    for (std::size_t part = 0; part < kParts; ++part) {
      const std::size_t of_square = cells_ * channels_[part];
      const std::size_t whole =
          of_square * across_ * static_cast<std::size_t>(shape_.overlap / shape_.square());
      own.values[part].resize(own.squares_p.size() * own.squares_q.size());
      // In stretches that the second cache holds, and whose sums do not overflow.
      const std::size_t maximum = max_values(static_cast<Part>(part));
      for (std::size_t from = 0; from < whole; from += maximum) {
        const Stretch stretch{first, of_square, from, std::min(maximum, whole - from)};
        gather(own.squares_p, true, beside, stretch, own.p);
        gather(own.squares_q, false, beside, stretch, own.q);
        squared_distances(own.p, own.q, unit, from == 0 ? Into::kNew : Into::kSum, own.values[part].data());
      }
      first += of_square;
    }
    return {own.values[kMotion], own.values[kDynamics], own.values[kTextureness]};
  }

 private:
  // Values [from, from + length) of one part of a strip, the part's values of its squares in a row.
  struct Stretch {
    std::size_t first, of_square;  // the part in a square's log features
    std::size_t from, length;
  };

  static double unit_of_square() {
    return std::is_same_v<Value, float> ? 1.0 : 1.0 / (double{kLogSteps} * kLogSteps);
  }

  static double sum_of_squares(std::span<const Value> log_features) {
    using Sum = std::conditional_t<std::is_same_v<Value, float>, double, std::int64_t>;
    Sum sum = 0;
    for (const Value feature : log_features) sum += Sum{feature} * feature;
    return static_cast<double>(sum);
  }

  const std::uint32_t* squares_of_row(stored::Row row) const {
    const auto place = std::lower_bound(rows_.begin(), rows_.end(), row) - rows_.begin();
    return places_.data() + static_cast<std::size_t>(place) * across_ * across_;
  }

  void find_squares(std::size_t piece, std::vector<const std::uint32_t*>& squares) const {
    squares.clear();
    for (const stored::Row row : candidates_.rows_of(piece)) squares.push_back(squares_of_row(row));
  }

  // far   the strip at the right or lower edge of a patch, else the one at its left or upper edge.
  void gather(std::span<const std::uint32_t* const> squares, bool far, bool beside, const Stretch& stretch,
              Panel<Value>& panel) const {
    const auto overlap = static_cast<std::size_t>(shape_.overlap / shape_.square());
    const std::size_t rest = far ? across_ - overlap : 0;
    const std::size_t columns = beside ? overlap : across_;
    const std::size_t corner = beside ? rest : rest * across_;
    panel.resize(squares.size(), stretch.length);
    for (std::size_t label = 0; label < squares.size(); ++label) {
      Value* to = panel.vector(label);
      std::size_t left = stretch.length, at = stretch.from % stretch.of_square;
      for (std::size_t k = stretch.from / stretch.of_square; left > 0; ++k, at = 0) {
        const std::size_t square = squares[label][corner + k / columns * across_ + k % columns];
        const std::size_t count = std::min(left, stretch.of_square - at);
        std::memcpy(to, log_features_.get() + square * shape_.square_values() + stretch.first + at,
                    count * sizeof(Value));
        to += count;
        left -= count;
      }
    }
  }

  const Target& target_;
  const Candidates& candidates_;
  const FeatureShape shape_;
  const FeatureSource& source_;
  const std::array<std::size_t, kParts> channels_;
  const std::size_t cells_, across_;              // of a square; squares on a patch's side
  std::vector<stored::Row> rows_;                 // ascending
  std::vector<std::uint32_t> places_;             // of their squares
  std::unique_ptr<Value[]> log_features_;         // by square
  std::vector<std::array<double, 2>> strengths_;  // by square: sums of squares of motion and of dynamics
};

template <class Value>
void visit(const Target& target, const Candidates& candidates, const FeatureShape& shape,
           const FeatureSource& source, const PartsWanted& wanted, const PartsSink& sink,
           std::stop_token stop) {
  const auto throw_if_cancelled = [&] {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "labelling", "stopped");
  };
  const Rows rows = lay_rows(target, candidates, wanted);
  Comparison<Value> comparison(target, candidates, shape, source);
  std::vector<std::vector<Square>> squares_of(rows.pieces.size());
  oneapi::tbb::parallel_for(std::size_t{0}, squares_of.size(), [&](std::size_t row) {
    squares_of[row] = comparison.squares_of(rows.candidates[row]);
  });
  oneapi::tbb::enumerable_thread_specific<typename Comparison<Value>::Scratch> scratch;
  const std::size_t max_squares = wanted.memory_bytes / (shape.square_values() * sizeof(Value));
  for (std::size_t first = 0, end = 0; first < rows.pieces.size(); first = end) {
    throw_if_cancelled();
    // As many rows as fit, and at least one, together with the one above them.
    std::vector<Square> squares;
    std::vector<stored::Row> held;
    if (first > 0) squares = squares_of[first - 1], held = rows.candidates[first - 1];
    for (; end < rows.pieces.size(); ++end) {
      std::vector<Square> more = merged(squares, squares_of[end]);
      if (end > first && more.size() > max_squares) break;
      squares = std::move(more);
      held = merged(held, rows.candidates[end]);
    }
    comparison.read(std::move(held), squares);
    throw_if_cancelled();
    std::vector<std::uint32_t> pieces;
    std::vector<std::size_t> edges;
    for (std::size_t row = first; row < end; ++row) {
      for (const std::uint32_t piece : rows.pieces[row])
        if (wanted.pieces.empty() || wanted.pieces[piece]) pieces.push_back(piece);
      edges.insert(edges.end(), rows.edges[row].begin(), rows.edges[row].end());
    }
    oneapi::tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
      sink.piece(pieces[i], comparison.piece(pieces[i], scratch.local()));
    });
    oneapi::tbb::parallel_for(std::size_t{0}, edges.size(), [&](std::size_t i) {
      if (!stop.stop_requested()) sink.edge(edges[i], comparison.edge(edges[i], scratch.local()));
    });
  }
  throw_if_cancelled();
}

}  // namespace

void visit_parts(const Target& target, const Candidates& candidates, const FeatureShape& shape, CostForm form,
                 const FeatureSource& source, const PartsWanted& wanted, const PartsSink& sink,
                 std::stop_token stop) {
  assert(candidates.pieces() == target.size());
  if (shape.overlap == 0) return;
  if (form == CostForm::kLog)
    visit<std::int16_t>(target, candidates, shape, source, wanted, sink, stop);
  else
    visit<float>(target, candidates, shape, source, wanted, sink, stop);
}

void weigh(const EdgeParts& parts, const PairwiseOptions& options, std::span<PairCost> out) {
  const auto motion = static_cast<float>(options.lambda);
  const auto dynamics = static_cast<float>(options.lambda * options.sigma);
  const auto textureness = static_cast<float>(options.lambda * options.rho);
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = motion * parts.motion[i] + dynamics * parts.dynamics[i] + textureness * parts.textureness[i];
}

void add_votes(const PieceParts& parts, const PairwiseOptions& options, std::span<float> unary) {
  if (options.vote == 0) return;
  std::vector<float> strengths(unary.size());
  for (std::size_t i = 0; i < unary.size(); ++i)
    strengths[i] = static_cast<float>(
        std::sqrt(options.lambda * (parts.motion[i] + options.sigma * double{parts.dynamics[i]})));
  std::vector<float> sorted = strengths;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const float median = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < unary.size(); ++i) {
    const float distance = strengths[i] - median;
    unary[i] += static_cast<float>(options.vote) * distance * distance;
  }
}

}  // namespace freshet::query
