#include "query/pairwise_parts.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "freshet_error.h"
#include "query/squared_distances.h"
#include "vision/patch_features.h"

namespace freshet::query {
namespace {

constexpr float kFrameRate = 25;             // frames a second, of the paper's px a frame
constexpr float kSpeedFloor = 2.5f;          // px/s; slower motion is as good as none
constexpr float kPowerFloor = 1;             // (px/s)^2
constexpr float kTextureFloor = 1.0f / 512;  // half a grey level of 8 bits

// Natural logarithm of 1 + x, x >= 0, to 2e-7 of its size or of 1. The C library's takes other code, and
// gives other last bits, on machines with fused multiply-add; this one is the same everywhere, and is
// vectorised (log1p took two thirds of the time of all tables).
inline float log_1_plus(float x) {
  const float y = 1 + x;
  const auto bits = std::bit_cast<std::int32_t>(y);
  const std::int32_t exponent = (bits - std::bit_cast<std::int32_t>(0.70710678f)) >> 23;
  const float f = std::bit_cast<float>(bits - exponent * (1 << 23)) - 1;  // y = (1 + f) * 2^exponent
  const float s = f / (2 + f), s2 = s * s;  // log(1 + f) = 2 artanh(s), |s| <= 0.172
  const float series = 1 + s2 * (1.0f / 3 + s2 * (1.0f / 5 + s2 * (1.0f / 7 + s2 * (1.0f / 9))));
  return 0.69314718f * static_cast<float>(exponent) + 2 * s * series;
}

// The channels of a cell, part by part.
struct Channels {
  int first, count;
};
struct PartChannels {
  Channels motion, dynamics, textureness;
};
PartChannels channels_of(const FeatureShape& shape) {
  const int powers = 2 * shape.bands;
  return {{0, 2}, {2, powers}, {2 + powers, vision::kTextureLevels}};
}

// Turns features into values whose squared distances over an overlap sum to the parts' means over its cells.
void scale_features(const FeatureShape& shape, CostForm form, std::span<float> features) {
  assert(features.size() % static_cast<std::size_t>(shape.channels()) == 0);
  const auto share = static_cast<float>(1 / std::sqrt(static_cast<double>(shape.overlap * shape.cells)));
  const int powers = 2 * shape.bands;
  for (float* cell = features.data(); cell != features.data() + features.size(); cell += shape.channels()) {
    float* const bands = cell + 2;
    float* const levels = bands + powers;
    if (form == CostForm::kPower) {
      for (int i = 0; i < 2; ++i) cell[i] *= share / kFrameRate;
      for (int i = 0; i < powers; ++i) bands[i] *= share / (kFrameRate * kFrameRate);
      for (int i = 0; i < vision::kTextureLevels; ++i) levels[i] *= share;
      continue;
    }
    const float speed = std::sqrt(cell[0] * cell[0] + cell[1] * cell[1]);
    const float shrink = speed > 1e-6f ? log_1_plus(speed / kSpeedFloor) / speed : 1 / kSpeedFloor;
    for (int i = 0; i < 2; ++i) cell[i] *= shrink * share;
    for (int i = 0; i < powers; ++i)
      bands[i] = 0.5f * log_1_plus(std::max(0.0f, bands[i]) / kPowerFloor) * share;
    for (int i = 0; i < vision::kTextureLevels; ++i) {
      levels[i] = log_1_plus(std::max(0.0f, levels[i]) / kTextureFloor) * share;
    }
  }
}

// Scaled features of the candidates of one piece row's pieces, each distinct patch once: neighbours share
// many.
struct Band {
  std::vector<Row> rows;                            // ascending, distinct
  std::vector<float> features;                      // rows * shape.values()
  std::vector<float> still_motion, still_dynamics;  // of a row

  std::size_t place_of(Row row) const {
    return static_cast<std::size_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
  }
};

// The mean over all cells of a patch of some channels' squares.
float mean_square(const FeatureShape& shape, std::span<const float> features, Channels channels) {
  double sum = 0;
  for (const float* cell = features.data(); cell != features.data() + features.size();
       cell += shape.channels())
    for (int i = channels.first; i < channels.first + channels.count; ++i)
      sum += static_cast<double>(cell[i]) * cell[i];
  return static_cast<float>(sum * shape.overlap / shape.cells);
}

struct Region {
  int column, row, columns, rows;  // cells
};

// Some channels of the candidates' cells inside a region.
void pack(const FeatureShape& shape, const Band& band, std::span<const Row> candidates, const Region& region,
          Channels channels, Panel& panel) {
  const auto count = static_cast<std::size_t>(channels.count);
  panel.resize(candidates.size(), static_cast<std::size_t>(region.columns * region.rows) * count);
  for (std::size_t label = 0; label < candidates.size(); ++label) {
    const auto features =
        std::span(band.features).subspan(band.place_of(candidates[label]) * shape.values(), shape.values());
    std::size_t at = 0;
    for (int row = region.row; row < region.row + region.rows; ++row)
      for (int column = region.column; column < region.column + region.columns; ++column, at += count)
        panel.set(label, at,
                  features.subspan(static_cast<std::size_t>((row * shape.cells + column) * shape.channels() +
                                                            channels.first),
                                   count));
  }
}

// One thread's place for an edge.
struct Scratch {
  Panel p, q;
  std::vector<float> motion, dynamics, textureness;
};

struct Side {
  const Band& band;
  std::span<const Row> candidates;
  Region region;
};

EdgeParts parts_between(const FeatureShape& shape, const Side& p, const Side& q, Scratch& own) {
  const PartChannels channels = channels_of(shape);
  const auto distances = [&](Channels part, std::vector<float>& out) {
    pack(shape, p.band, p.candidates, p.region, part, own.p);
    pack(shape, q.band, q.candidates, q.region, part, own.q);
    out.resize(p.candidates.size() * q.candidates.size());
    squared_distances(own.p, own.q, out);
  };
  distances(channels.motion, own.motion);
  distances(channels.dynamics, own.dynamics);
  distances(channels.textureness, own.textureness);
  return {own.motion, own.dynamics, own.textureness};
}

void read_band(const FeatureShape& shape, CostForm form, const FeatureSource& source, Band& band) {
  std::sort(band.rows.begin(), band.rows.end());
  band.rows.erase(std::unique(band.rows.begin(), band.rows.end()), band.rows.end());
  if (!band.rows.empty() && source.prepare) source.prepare(band.rows);
  band.features.resize(band.rows.size() * shape.values());
  band.still_motion.resize(band.rows.size());
  band.still_dynamics.resize(band.rows.size());
  const PartChannels channels = channels_of(shape);
  oneapi::tbb::parallel_for(std::size_t{0}, band.rows.size(), [&](std::size_t i) {
    const auto features = std::span(band.features).subspan(i * shape.values(), shape.values());
    source.read(band.rows[i], features);
    scale_features(shape, form, features);
    band.still_motion[i] = mean_square(shape, features, channels.motion);
    band.still_dynamics[i] = mean_square(shape, features, channels.dynamics);
  });
}

}  // namespace

void visit_parts(const Target& target, const Candidates& candidates, const FeatureShape& shape, CostForm form,
                 const FeatureSource& source, const PartsWanted& wanted, const PartsSink& sink,
                 std::stop_token stop) {
  assert(candidates.pieces() == target.size());
  if (shape.overlap == 0) return;
  const auto wants = [](const std::vector<bool>& some, std::size_t i) { return some.empty() || some[i]; };
  std::vector<bool> needed(target.size());  // pieces whose candidates' features are
  for (std::size_t piece = 0; piece < target.size(); ++piece) needed[piece] = wants(wanted.pieces, piece);
  std::vector<std::vector<std::size_t>> edges_of_row(target.rows);  // by the row of q
  for (std::size_t e = 0; e < target.edges.size(); ++e) {
    if (!wants(wanted.edges, e)) continue;
    const auto [p, q] = target.edges[e];
    needed[p] = needed[q] = true;
    edges_of_row[target.places[q].y].push_back(e);
  }
  std::vector<std::vector<std::uint32_t>> pieces_of_row(target.rows);
  for (std::uint32_t piece = 0; piece < target.size(); ++piece)
    if (needed[piece]) pieces_of_row[target.places[piece].y].push_back(piece);

  oneapi::tbb::enumerable_thread_specific<Scratch> scratch;
  Band above, band;
  for (int row = 0; row < target.rows; ++row) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "labelling", "stopped");
    std::swap(above, band);
    band.rows.clear();
    for (const std::uint32_t piece : pieces_of_row[row]) {
      const auto rows = candidates.rows_of(piece);
      band.rows.insert(band.rows.end(), rows.begin(), rows.end());
    }
    read_band(shape, form, source, band);
    oneapi::tbb::parallel_for(std::size_t{0}, pieces_of_row[row].size(), [&](std::size_t i) {
      const std::uint32_t piece = pieces_of_row[row][i];
      if (!wants(wanted.pieces, piece)) return;
      Scratch& own = scratch.local();
      own.motion.clear();
      own.dynamics.clear();
      for (const Row candidate : candidates.rows_of(piece)) {
        const std::size_t place = band.place_of(candidate);
        own.motion.push_back(band.still_motion[place]);
        own.dynamics.push_back(band.still_dynamics[place]);
      }
      sink.piece(piece, {own.motion, own.dynamics});
    });
    const int rest = shape.cells - shape.overlap;
    oneapi::tbb::parallel_for(std::size_t{0}, edges_of_row[row].size(), [&](std::size_t i) {
      const std::size_t e = edges_of_row[row][i];
      const auto [p, q] = target.edges[e];
      const bool beside = target.places[p].y == row;
      const Region of_p =
          beside ? Region{rest, 0, shape.overlap, shape.cells} : Region{0, rest, shape.cells, shape.overlap};
      const Region of_q =
          beside ? Region{0, 0, shape.overlap, shape.cells} : Region{0, 0, shape.cells, shape.overlap};
      sink.edge(e, parts_between(shape, {beside ? band : above, candidates.rows_of(p), of_p},
                                 {band, candidates.rows_of(q), of_q}, scratch.local()));
    });
  }
}

void weigh(const EdgeParts& parts, const PairwiseOptions& options, std::span<float> out) {
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

std::size_t table_bytes(const Target& target, const Candidates& candidates) {
  std::size_t pairs = 0;
  for (const auto& [p, q] : target.edges) pairs += std::size_t{candidates.counts[p]} * candidates.counts[q];
  return pairs * sizeof(float);
}

PairwiseParts find_parts(const Target& target, const Candidates& candidates, const FeatureShape& shape,
                         CostForm form, const FeatureSource& source, std::stop_token stop) {
  PairwiseParts parts;
  parts.form = form;
  if (shape.overlap == 0) return parts;
  std::vector<std::size_t> first_label{0}, first_pair{0};
  for (const std::uint32_t count : candidates.counts) first_label.push_back(first_label.back() + count);
  for (const auto& [p, q] : target.edges)
    first_pair.push_back(first_pair.back() + std::size_t{candidates.counts[p]} * candidates.counts[q]);
  for (auto* values : {&parts.still_motion, &parts.still_dynamics}) values->resize(first_label.back());
  for (auto* values : {&parts.motion, &parts.dynamics, &parts.textureness}) values->resize(first_pair.back());
  const auto put = [](std::span<const float> from, std::vector<float>& to, std::size_t at) {
    std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(at));
  };
  const PartsSink sink{[&](std::uint32_t piece, const PieceParts& of) {
                         put(of.motion, parts.still_motion, first_label[piece]);
                         put(of.dynamics, parts.still_dynamics, first_label[piece]);
                       },
                       [&](std::size_t edge, const EdgeParts& of) {
                         put(of.motion, parts.motion, first_pair[edge]);
                         put(of.dynamics, parts.dynamics, first_pair[edge]);
                         put(of.textureness, parts.textureness, first_pair[edge]);
                       }};
  visit_parts(target, candidates, shape, form, source, {}, sink, stop);
  return parts;
}

Mrf combine(const Target& target, const Candidates& candidates, const PairwiseParts& parts,
            const PairwiseOptions& options) {
  check_weights(options);
  assert(options.form == parts.form);
  Mrf mrf = unconnected_field(target, candidates);
  if (options.lambda == 0 || parts.still_motion.empty()) return mrf;
  for (std::size_t piece = 0; piece < mrf.nodes(); ++piece) {
    const std::size_t first = mrf.first_unary[piece], count = mrf.label_count[piece];
    add_votes({std::span(parts.still_motion).subspan(first, count),
               std::span(parts.still_dynamics).subspan(first, count)},
              options, std::span(mrf.unary).subspan(first, count));
  }
  weigh({parts.motion, parts.dynamics, parts.textureness}, options, mrf.pairwise);
  return mrf;
}

}  // namespace freshet::query
