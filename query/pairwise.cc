#include "query/pairwise.h"

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

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

// Features of the candidates of one piece row's pieces, each distinct patch once: neighbours share many.
struct Band {
  std::vector<Row> rows;        // ascending, distinct
  std::vector<float> features;  // rows * shape.values()
  std::vector<float> strength;  // of a row's motion, in the features' own measure

  std::size_t place_of(Row row) const {
    return static_cast<std::size_t>(std::lower_bound(rows.begin(), rows.end(), row) - rows.begin());
  }
};

// How strongly a patch moves: the root of its mean motion's and dynamics' share of what W would be beside a
// patch that stands still.
float motion_strength(const FeatureShape& shape, std::span<const float> features) {
  const int moving = 2 + 2 * shape.bands;
  double sum = 0;
  for (const float* cell = features.data(); cell != features.data() + features.size();
       cell += shape.channels())
    for (int i = 0; i < moving; ++i) sum += static_cast<double>(cell[i]) * cell[i];
  return static_cast<float>(std::sqrt(sum * shape.overlap / shape.cells));
}

struct Region {
  int column, row, columns, rows;  // cells
};

void pack(const FeatureShape& shape, const Band& band, std::span<const Row> candidates, const Region& region,
          Panel& panel) {
  const auto channels = static_cast<std::size_t>(shape.channels());
  const std::size_t row_values = static_cast<std::size_t>(region.columns) * channels;
  panel.resize(candidates.size(), row_values * static_cast<std::size_t>(region.rows));
  for (std::size_t label = 0; label < candidates.size(); ++label) {
    const auto features =
        std::span(band.features).subspan(band.place_of(candidates[label]) * shape.values(), shape.values());
    for (int row = 0; row < region.rows; ++row) {
      const std::size_t from =
          (static_cast<std::size_t>(region.row + row) * static_cast<std::size_t>(shape.cells) +
           static_cast<std::size_t>(region.column)) *
          channels;
      panel.set(label, static_cast<std::size_t>(row) * row_values, features.subspan(from, row_values));
    }
  }
}

// Candidates vote on how strongly a piece moves: each pays for its distance from their median.
void add_votes(const Band& band, std::span<const Row> candidates, const PairwiseOptions& options, Mrf& mrf,
               std::uint32_t piece) {
  if (options.vote == 0) return;
  std::vector<float> strengths;
  for (const Row row : candidates) strengths.push_back(band.strength[band.place_of(row)]);
  std::vector<float> sorted = strengths;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const float median = sorted[sorted.size() / 2];
  float* const unary = mrf.unary.data() + mrf.first_unary[piece];
  for (std::size_t i = 0; i < strengths.size(); ++i) {
    const float distance = strengths[i] - median;
    unary[i] += static_cast<float>(options.vote) * distance * distance;
  }
}

}  // namespace

CostForm parse_cost_form(const std::string& name) {
  for (const CostForm form : {CostForm::kLog, CostForm::kPower}) {
    if (name == name_of(form)) return form;
  }
  throw Error(ErrorKind::kUsage, "cost form \"" + name + "\"", "no such form", "Use log or power");
}

const char* name_of(CostForm form) { return form == CostForm::kLog ? "log" : "power"; }

PairwiseOptions default_costs(CostForm form) {
  PairwiseOptions options;
  if (form == CostForm::kPower) options = {CostForm::kPower, 0.01, 100, 100 * 100, 0};
  return options;
}

int FeatureShape::channels() const { return 2 + 2 * bands + vision::kTextureLevels; }

std::size_t FeatureShape::values() const { return static_cast<std::size_t>(cells) * cells * channels(); }

FeatureShape feature_shape(const vision::Settings& settings) {
  const int cell = settings.spectrum.cell, side = settings.grid.patch, stride = settings.grid.stride;
  if (side % cell != 0 || stride % cell != 0) {
    throw Error(ErrorKind::kUsage, "the store's settings",
                "patches of " + std::to_string(side) + " px every " + std::to_string(stride) +
                    " px do not share whole cells of " + std::to_string(cell) + " px",
                "Make the store again with a stride that is a multiple of the cell");
  }
  FeatureShape shape;
  shape.cells = side / cell;
  shape.bands = vision::motion_bands(settings.spectrum);
  shape.overlap = std::max(0, (side - stride) / cell);
  assert(shape.channels() == vision::feature_channels(settings.spectrum));
  return shape;
}

void weigh_features(const FeatureShape& shape, const PairwiseOptions& options, std::span<float> features) {
  assert(features.size() % static_cast<std::size_t>(shape.channels()) == 0);
  const double cells = std::max(1, shape.overlap * shape.cells);
  const auto root = [&](double weight) { return static_cast<float>(std::sqrt(weight / cells)); };
  const float motion = root(options.lambda), power = root(options.lambda * options.sigma);
  const float texture = root(options.lambda * options.rho);
  const int powers = 2 * shape.bands;
  for (float* cell = features.data(); cell != features.data() + features.size(); cell += shape.channels()) {
    float* const bands = cell + 2;
    float* const levels = bands + powers;
    if (options.form == CostForm::kPower) {
      for (int i = 0; i < 2; ++i) cell[i] *= motion / kFrameRate;
      for (int i = 0; i < powers; ++i) bands[i] *= power / (kFrameRate * kFrameRate);
      for (int i = 0; i < vision::kTextureLevels; ++i) levels[i] *= texture;
      continue;
    }
    const float speed = std::sqrt(cell[0] * cell[0] + cell[1] * cell[1]);
    const float shrink = speed > 1e-6f ? log_1_plus(speed / kSpeedFloor) / speed : 1 / kSpeedFloor;
    for (int i = 0; i < 2; ++i) cell[i] *= shrink * motion;
    for (int i = 0; i < powers; ++i)
      bands[i] = 0.5f * log_1_plus(std::max(0.0f, bands[i]) / kPowerFloor) * power;
    for (int i = 0; i < vision::kTextureLevels; ++i) {
      levels[i] = log_1_plus(std::max(0.0f, levels[i]) / kTextureFloor) * texture;
    }
  }
}

Mrf build_mrf(const Target& target, const Candidates& candidates, const FeatureShape& shape,
              const PairwiseOptions& options, const FeatureSource& source, std::stop_token stop) {
  for (const double weight : {options.lambda, options.sigma, options.rho, options.vote}) {
    if (!(weight >= 0) || !std::isfinite(weight)) {
      throw Error(ErrorKind::kUsage, "lambda, sigma, rho, vote", "a weight that is negative or no number");
    }
  }
  assert(candidates.pieces() == target.size());
  Mrf mrf;
  std::vector<float> costs;
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    costs.clear();
    for (const float score : candidates.scores_of(piece)) costs.push_back(1 - score);
    mrf.add_node(costs);
  }
  std::size_t pairs = 0;
  for (const auto& [p, q] : target.edges) pairs += std::size_t{mrf.label_count[p]} * mrf.label_count[q];
  mrf.pairwise.reserve(pairs);
  std::vector<std::vector<std::size_t>> edges_of_row(target.rows);  // by the row of q
  for (const auto& [p, q] : target.edges) edges_of_row[target.places[q].y].push_back(mrf.add_edge(p, q));
  if (shape.overlap == 0 || options.lambda == 0) return mrf;

  std::vector<std::vector<std::uint32_t>> pieces_of_row(target.rows);
  for (std::uint32_t piece = 0; piece < target.size(); ++piece) {
    pieces_of_row[target.places[piece].y].push_back(piece);
  }

  struct Panels {
    Panel p, q;
  };
  oneapi::tbb::enumerable_thread_specific<Panels> panels;
  Band above, band;
  for (int row = 0; row < target.rows; ++row) {
    if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "labelling", "stopped");
    std::swap(above, band);
    band.rows.clear();
    for (const std::uint32_t piece : pieces_of_row[row]) {
      const auto rows = candidates.rows_of(piece);
      band.rows.insert(band.rows.end(), rows.begin(), rows.end());
    }
    std::sort(band.rows.begin(), band.rows.end());
    band.rows.erase(std::unique(band.rows.begin(), band.rows.end()), band.rows.end());
    if (source.prepare) source.prepare(band.rows);
    band.features.resize(band.rows.size() * shape.values());
    band.strength.resize(band.rows.size());
    oneapi::tbb::parallel_for(std::size_t{0}, band.rows.size(), [&](std::size_t i) {
      const auto features = std::span(band.features).subspan(i * shape.values(), shape.values());
      source.read(band.rows[i], features);
      weigh_features(shape, options, features);
      band.strength[i] = motion_strength(shape, features);
    });
    for (const std::uint32_t piece : pieces_of_row[row])
      add_votes(band, candidates.rows_of(piece), options, mrf, piece);
    const int rest = shape.cells - shape.overlap;
    oneapi::tbb::parallel_for(std::size_t{0}, edges_of_row[row].size(), [&](std::size_t e) {
      const Mrf::Edge& edge = mrf.edges[edges_of_row[row][e]];
      const bool beside = target.places[edge.p].y == row;
      const Region of_p =
          beside ? Region{rest, 0, shape.overlap, shape.cells} : Region{0, rest, shape.cells, shape.overlap};
      const Region of_q =
          beside ? Region{0, 0, shape.overlap, shape.cells} : Region{0, 0, shape.cells, shape.overlap};
      Panels& own = panels.local();
      pack(shape, beside ? band : above, candidates.rows_of(edge.p), of_p, own.p);
      pack(shape, band, candidates.rows_of(edge.q), of_q, own.q);
      squared_distances(own.p, own.q, {mrf.table(edge), own.p.count() * own.q.count()});
    });
  }
  return mrf;
}

}  // namespace freshet::query
