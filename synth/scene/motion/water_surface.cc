#include "synth/scene/motion/water_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <utility>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "platform/vectors.h"

namespace freshet::synth::scene {
namespace {

constexpr double kMinBelow = 0.5;   // px: no pixel's middle on the horizon
constexpr double kCalm = 0.35;      // of a tile's samples: a pixel that covers more sees no wave
constexpr float kHighest = 0.4f;    // of the camera's height: no wave reaches the lens
constexpr float kSteepest = 0.35f;  // slope
// Deviation of what displacements of neighbouring rows differ by, px: above 1 they fold. Beyond it the shortest waves
// are left out. Mirror images fold on real water too.
constexpr double kMostStep = 0.35;
constexpr double kMostMirroredStep = 2.5;
constexpr int kMoments = 4;           // of the cycle, at which that is measured
constexpr double kAround = 0.025;     // of the picture's height, to both sides, over which it is averaged
constexpr int kCoarsest = 7;          // 2^7 times what kFinest leaves
constexpr double kFinest = 320;       // px of the longer side: more show no shorter waves
constexpr double kMirrorsBelow = 17;  // degrees
constexpr double kGain = 2;           // of waves' heights by the wind's speed, at the mean: H ~ v^2

/// Linear between samples and periodic; n a power of 2.
inline float sampled(const float* row, float place, int n) {
  const float whole = std::floor(place);
  const int i = static_cast<int>(whole) & (n - 1);
  const float a = row[i], b = row[(i + 1) & (n - 1)];
  return a + (b - a) * (place - whole);
}

struct HeightRow {
  const float* profile[HeightField::kMaxTiles];
  float place[HeightField::kMaxTiles], step[HeightField::kMaxTiles];
  int n;
  float along, down, depth, lean, highest;
};

/// px, to both sides, over which steps are averaged.
int lines_around(cv::Size picture) { return std::max(2, cvRound(kAround * picture.height)); }

cv::Rect with_lines_around(const cv::Rect& box, cv::Size picture) {
  const int more = lines_around(picture) + 1;
  return {box.x, box.y - more, box.width, box.height + 2 * more};
}

/// The same waves, as high, by what lifts boats.
WaterMotion lifting(WaterMotion water) {
  water.amplitude = water.amplitude_or_usual();
  water.mapping = WaterMapping::kDisplacement;
  return water;
}

/// d' of a row of pixels under heights, rolled frame: minus Eq. 10.
template <int kTiles>
[[gnu::always_inline]] inline void lift_each(const HeightRow& row, const float* gain, int n, float* dx,
                                             float* dy) {
  for (int i = 0; i < n; ++i) {
    const float at = static_cast<float>(i);
    float h = sampled(row.profile[0], row.place[0] + at * row.step[0], row.n);
    for (int tile = 1; tile < kTiles; ++tile)
      h += sampled(row.profile[tile], row.place[tile] + at * row.step[tile], row.n);
    h *= gain[i];
    h = h < row.highest ? (h > -row.highest ? h : -row.highest) : row.highest;
    const float over = h / (row.depth - h * row.lean);
    dx[i] = -(row.along + at) * (over * row.lean);
    dy[i] = -over * row.down;
  }
}
FRESHET_WIDE void lift_row(const HeightRow& row, const float* gain, int n, float* dx, float* dy) {
  lift_each<HeightField::kTiles>(row, gain, n, dx, dy);
}
FRESHET_WIDE void lift_row_of_all(const HeightRow& row, const float* gain, int n, float* dx, float* dy) {
  lift_each<HeightField::kMaxTiles>(row, gain, n, dx, dy);
}

}  // namespace

WaterMapping mapping_seen(const WaterMotion& water, const cv::Rect& region, cv::Size picture) {
  const WaterCamera camera(*water.horizon, *water.focal_px, water.camera_height_m, picture);
  for (const cv::Point corner : {cv::Point(region.x, region.br().y), region.br()}) {
    const double below = camera.rolled(corner.x, corner.y).y;
    if (below <= camera.horizon()) continue;
    const double seen = std::atan2(water.camera_height_m, camera.row(below).forward) * 180 / std::numbers::pi;
    if (seen < 0 || seen > kMirrorsBelow) return WaterMapping::kDisplacement;
  }
  return WaterMapping::kNormals;
}

WaterSurface::WaterSurface(const WaterMotion& water, const Gusts& gusts, const Cycle& cycle,
                           std::uint64_t seed, const cv::Rect& region, cv::Size picture,
                           const cv::Rect& boats)
    : water_(water),
      gusts_(&gusts),
      cycle_(cycle),
      camera_(*water.horizon, *water.focal_px, water.camera_height_m, picture),
      focal_(*water.focal_px),
      picture_(picture),
      field_(
          water, gusts.wind(), cycle, seed,
          water.mapping == WaterMapping::kNormals ? HeightField::What::kSlopes : HeightField::What::kHeights),
      reduced_(static_cast<std::size_t>(field_.planes()), ReducedTile(field_.samples())) {
  if (water.mapping == WaterMapping::kNormals && !boats.empty())
    heights_ = std::make_unique<WaterSurface>(lifting(water), gusts, cycle, seed,
                                              with_lines_around(boats, picture), picture);
  const cv::Rect asked = region | boats;
  double top = 1e9, bottom = -1e9;
  for (const cv::Point corner :
       {asked.tl(), cv::Point(asked.br().x, asked.y), cv::Point(asked.x, asked.br().y), asked.br()}) {
    const double below = camera_.rolled(corner.x, corner.y).y;
    top = std::min(top, below), bottom = std::max(bottom, below);
  }
  // Without roll lines are the pictures' rows: their middles lie at whole lines.
  const double shift = camera_.rolled(0, 0).y - std::floor(camera_.rolled(0, 0).y);
  first_line_ = static_cast<int>(std::floor(top)) - 2;
  const int count = static_cast<int>(std::ceil(bottom)) + 3 - first_line_;
  lines_.resize(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    Line& line = lines_[static_cast<std::size_t>(i)];
    line.below = first_line_ + i + shift;
    if (line.below < camera_.horizon() + kMinBelow) continue;
    line.camera = camera_.row(line.below);
    for (int p = 0; p < field_.planes(); ++p) {
      const double per_m = field_.samples() / field_.side_m(field_.tile_of(p));
      if (line.camera.deep * per_m <= kCalm * field_.samples()) line.calm = false;
    }
  }
  profiles_.assign(
      static_cast<std::size_t>(count) * static_cast<std::size_t>(field_.planes() * field_.samples()), 0);
  highest_.assign(lines_.size(), 0);
  const auto columns = static_cast<std::size_t>(picture.width / kUnit + 2);
  gain_.assign(columns, 1);
  shade_.assign(columns, 1);
  leave_out_folds();
}

float WaterSurface::sample_line(std::size_t i, float* scratch) {
  const Line& line = lines_[i];
  const int n = field_.samples();
  float sum = 0;
  for (int p = 0; p < field_.planes(); ++p) {
    const double per_m = n / field_.side_m(field_.tile_of(p));
    float* out = profile(i, p);
    sample_row(reduced_[static_cast<std::size_t>(p)], line.camera.forward * per_m,
               line.coarse * line.camera.scale * per_m, line.coarse * line.camera.deep * per_m, n, out,
               scratch);
    for (int k = 0; k < n; ++k) out[k] *= line.held;
    const auto [low, high] = std::minmax_element(out, out + n);
    sum += std::max(-*low, *high);
  }
  return sum;
}

void WaterSurface::sample_lines() {
  oneapi::tbb::parallel_for(0, field_.planes(),
                            [&](int p) { reduced_[static_cast<std::size_t>(p)].set(field_.plane(p)); });
  using oneapi::tbb::blocked_range;
  oneapi::tbb::parallel_for(blocked_range<std::size_t>(0, lines_.size(), 16),
                            [&](const blocked_range<std::size_t>& range) {
                              std::vector<float> scratch(static_cast<std::size_t>(2 * field_.samples()));
                              for (std::size_t i = range.begin(); i < range.end(); ++i)
                                highest_[i] = lines_[i].calm ? 0 : sample_line(i, scratch.data());
                            });
}

double WaterSurface::down_of(const Line& line, int plane) const {
  if (water_.mapping == WaterMapping::kNormals) return plane % 2 == 1 ? 2 * focal_ : 0;
  return line.camera.down / line.camera.depth;
}

double WaterSurface::step_power(std::size_t line) const {
  const int n = field_.samples();
  double sum = 0;
  for (int p = 0; p < field_.planes(); ++p) {
    const double upper = down_of(lines_[line], p), lower = down_of(lines_[line + 1], p);
    const float *above = profile(line, p), *below = profile(line + 1, p);
    for (int k = 0; k < n; ++k) {
      const double step = lower * below[k] - upper * above[k];
      sum += step * step;
    }
  }
  return sum / n;
}

void WaterSurface::need_line(const Line& line, float coarse) {
  for (int p = 0; p < field_.planes() && !line.calm; ++p) {
    const double per_m = coarse * field_.samples() / field_.side_m(field_.tile_of(p));
    need_row(reduced_[static_cast<std::size_t>(p)], line.camera.scale * per_m, line.camera.deep * per_m);
  }
}

void WaterSurface::need_nothing() {
  reduced_.assign(static_cast<std::size_t>(field_.planes()), ReducedTile(field_.samples()));
}

std::vector<double> WaterSurface::step_powers(float coarse) {
  need_nothing();
  for (Line& line : lines_) {
    line.coarse = coarse;
    need_line(line, coarse);
  }
  std::vector<double> power(lines_.size(), 0);
  for (int moment = 0; moment < kMoments; ++moment) {
    field_.go_to(moment * cycle_.frames / kMoments, seconds_);
    sample_lines();
    for (std::size_t i = 0; i + 1 < lines_.size(); ++i)
      if (!lines_[i].calm && !lines_[i + 1].calm) power[i] += step_power(i) / kMoments;
  }
  std::vector<double> mean(lines_.size(), 0);
  const auto around = static_cast<std::size_t>(lines_around(picture_));
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::size_t first = i < around ? 0 : i - around, last = std::min(lines_.size(), i + around + 1);
    for (std::size_t k = first; k < last; ++k) mean[i] += power[k] / static_cast<double>(last - first);
  }
  return mean;
}

WaterSurface::Shown WaterSurface::without_folds() {
  const double most = water_.mapping == WaterMapping::kNormals ? kMostMirroredStep : kMostStep,
               most_power = most * most;
  const auto finest = static_cast<float>(std::max(1.0, std::max(picture_.width, picture_.height) / kFinest));
  std::vector<float> coarse(lines_.size(), finest), held(lines_.size(), 1);
  std::vector<double> finer = step_powers(finest);
  for (int level = 1; level <= kCoarsest; ++level) {
    if (*std::max_element(finer.begin(), finer.end()) <= most_power) break;
    const std::vector<double> power = step_powers(finest * std::exp2(static_cast<float>(level)));
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (finer[i] <= most_power) continue;
      // Between two levels powers are taken as falling evenly in their logarithms.
      const double part = power[i] < most_power ? std::log(finer[i] / most_power) /
                                                      std::log(finer[i] / std::max(power[i], 1e-12))
                                                : 1;
      coarse[i] = finest * static_cast<float>(std::exp2(level - 1 + part));
      held[i] = static_cast<float>(std::sqrt(std::min(1.0, most_power / std::max(power[i], 1e-12))));
    }
    finer = power;
  }
  return {std::move(coarse), std::move(held)};
}

void WaterSurface::leave_out_folds() {
  const Weather& weather = gusts_->weather();
  knots_ = weather.changes() ? weather.knots_s() : std::vector<double>{0};
  for (const double knot : knots_) {
    const Wind now = weather.at(knot);
    const auto same = std::ranges::find_if(knots_, [&](double other) {
      const Wind then = weather.at(other);
      return then.speed_m_per_s == now.speed_m_per_s && then.direction_deg == now.direction_deg;
    });
    const auto known = static_cast<std::size_t>(same - knots_.begin());
    seconds_ = knot;
    shown_.push_back(known < shown_.size() ? shown_[known] : without_folds());
  }
  constexpr float kFiner = 1.25f;  // levels are octaves: none between two of these is left out
  need_nothing();
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    float low = shown_[0].coarse[i], high = low;
    for (const Shown& shown : shown_)
      low = std::min(low, shown.coarse[i]), high = std::max(high, shown.coarse[i]);
    for (float coarse = low; coarse < high; coarse *= kFiner) need_line(lines_[i], coarse);
    need_line(lines_[i], high);
  }
  show(0, 0);
}

void WaterSurface::show(std::size_t first, float part) {
  const Shown& before = shown_[first];
  const Shown& after = shown_[std::min(first + 1, shown_.size() - 1)];
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    lines_[i].coarse = before.coarse[i] * std::pow(after.coarse[i] / before.coarse[i], part);
    lines_[i].held = before.held[i] + (after.held[i] - before.held[i]) * part;
  }
}

void WaterSurface::go_to(int frame) {
  if (heights_ != nullptr) heights_->go_to(frame);
  field_.go_to(frame);
  if (shown_.size() > 1) {
    const double now = cycle_.place(frame) / cycle_.fps;
    const auto after = static_cast<std::size_t>(std::ranges::upper_bound(knots_, now) - knots_.begin());
    const std::size_t first = after - 1;
    show(first, after < knots_.size()
                    ? static_cast<float>((now - knots_[first]) / (knots_[after] - knots_[first]))
                    : 0.0f);
  }
  sample_lines();
  if (gusts_->any()) {
    for (std::size_t i = 0; i < gain_.size(); ++i) {
      const float faster = gusts_->strength(static_cast<double>(i * kUnit), frame);
      gain_[i] = std::max(0.0f, 1 + static_cast<float>(kGain) * faster);
      const auto deviation = static_cast<float>(std::max(gusts_->wind().turbulence, 1e-6));
      shade_[i] = 1 - static_cast<float>(water_.gust_darkening) * std::clamp(faster / deviation, -1.0f, 2.0f);
    }
  }
  const double gain = *std::max_element(gain_.begin(), gain_.end());
  double reach = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i)
    if (!lines_[i].calm) reach = std::max(reach, reach_of(lines_[i].camera, highest_[i] * gain));
  reach_ = static_cast<float>(reach) + 1;
}

double WaterSurface::reach_of(const WaterCamera::Row& row, double most) const {
  if (water_.mapping == WaterMapping::kNormals) return 2 * focal_ * std::min<double>(kSteepest, most);
  const double h = std::min<double>(kHighest * water_.camera_height_m, most);
  const double over = h / std::max(1e-6, row.depth - h * std::abs(row.lean));
  return over * std::max(std::abs(row.down), std::abs(row.lean) * picture_.width);
}

float WaterSurface::gain_at(double x) const {
  const double at = std::clamp(x / kUnit, 0.0, static_cast<double>(gain_.size()) - 1.001);
  const auto i = static_cast<std::size_t>(at);
  const auto part = static_cast<float>(at - static_cast<double>(i));
  return gain_[i] + (gain_[i + 1] - gain_[i]) * part;
}

double WaterSurface::held_height(double m) const {
  const double most = kHighest * water_.camera_height_m;
  return std::clamp(m, -most, most);
}

WaterSurface::Surface WaterSurface::at(double below, double along) const {
  const double place = below - lines_[0].below;
  if (!(place >= 0) || place > static_cast<double>(lines_.size()) - 1) return {};
  const auto line = std::min(static_cast<std::size_t>(place), lines_.size() - 2);
  const auto part = static_cast<float>(place - static_cast<double>(line));
  Surface sum;
  const int n = field_.samples();
  for (std::size_t i = 0; i < 2; ++i) {
    const float weight = i == 0 ? 1 - part : part;
    if (weight == 0 || lines_[line + i].calm) continue;
    for (int p = 0; p < field_.planes(); ++p) {
      const double per_m = n / field_.side_m(field_.tile_of(p));
      const float value =
          weight *
          sampled(profile(line + i, p), static_cast<float>(along * lines_[line + i].camera.scale * per_m), n);
      (water_.mapping == WaterMapping::kNormals && p % 2 == 1 ? sum.second : sum.first) += value;
    }
  }
  return sum;
}

cv::Point2d WaterSurface::rolled_displacement(double below, double along, float gain) const {
  if (below < camera_.horizon() + kMinBelow) return {};
  const Surface surface = at(below, along);
  const WaterCamera::Row row = camera_.row(below);
  if (water_.mapping == WaterMapping::kNormals) {
    const float right = std::clamp(surface.first * gain, -kSteepest, kSteepest);
    const float away = std::clamp(surface.second * gain, -kSteepest, kSteepest);
    const double grazing = water_.camera_height_m / std::hypot(row.forward, water_.camera_height_m);
    return {2 * focal_ * right * grazing, 2 * focal_ * away};
  }
  const double h = held_height(surface.first * gain);
  const double over = h / (row.depth - h * row.lean);
  return {along * over * row.lean, over * row.down};
}

double WaterSurface::height(double x, double y) const {
  if (heights_ != nullptr) return heights_->height(x, y);
  assert(water_.mapping == WaterMapping::kDisplacement);
  const cv::Point2d p = camera_.rolled(x, y);
  return p.y < camera_.horizon() + kMinBelow ? 0 : held_height(at(p.y, p.x).first * gain_at(x));
}

cv::Point2d WaterSurface::displacement(double x, double y) const {
  if (heights_ != nullptr) return heights_->displacement(x, y);
  assert(water_.mapping == WaterMapping::kDisplacement);
  const cv::Point2d p = camera_.rolled(x, y);
  return camera_.upright(rolled_displacement(p.y, p.x, gain_at(x)));
}

void WaterSurface::row(int, int x, int y, int n, float* dx, float* dy) const {
  // Along an unrolled horizon a row lies on one line: the case that must be fast.
  const cv::Point2d first = camera_.rolled(x, y);
  if (camera_.roll_sin() == 0 && water_.mapping == WaterMapping::kDisplacement) {
    const double place = first.y - lines_[0].below;
    const auto line =
        static_cast<std::size_t>(std::clamp(std::round(place), 0.0, static_cast<double>(lines_.size() - 1)));
    if (lines_[line].calm) {
      std::fill(dx, dx + n, 0.0f);
      std::fill(dy, dy + n, 0.0f);
      return;
    }
    const WaterCamera::Row& camera = lines_[line].camera;
    HeightRow row{.profile = {},
                  .place = {},
                  .step = {},
                  .n = field_.samples(),
                  .along = static_cast<float>(first.x),
                  .down = static_cast<float>(camera.down),
                  .depth = static_cast<float>(camera.depth),
                  .lean = static_cast<float>(camera.lean),
                  .highest = static_cast<float>(kHighest * water_.camera_height_m)};
    for (int tile = 0; tile < field_.tiles(); ++tile) {
      const double per_px = camera.scale * row.n / field_.side_m(tile);
      row.profile[tile] = profile(line, tile);
      // From 0 on: a float keeps fractions of what is small.
      row.place[tile] = static_cast<float>(std::fmod(first.x * per_px, row.n));
      row.step[tile] = static_cast<float>(per_px);
    }
    for (int i = 0; i < n; ++i) dx[i] = gusts_->any() ? gain_at(x + i) : 1.0f;
    (field_.tiles() == HeightField::kTiles ? lift_row : lift_row_of_all)(row, dx, n, dx, dy);
    return;
  }
  for (int i = 0; i < n; ++i) {
    const cv::Point2d p = camera_.rolled(x + i, y);
    const cv::Point2d d =
        camera_.upright(rolled_displacement(p.y, p.x, gusts_->any() ? gain_at(x + i) : 1.0f));
    dx[i] = static_cast<float>(-d.x);
    dy[i] = static_cast<float>(-d.y);
  }
}

bool WaterSurface::light(int x, int y, int n, float* factor) const {
  if (!gusts_->any() || water_.gust_darkening == 0) return false;
  for (int i = 0; i < n; ++i) {
    const double at =
        std::clamp(static_cast<double>(x + i) / kUnit, 0.0, static_cast<double>(shade_.size()) - 1.001);
    const auto column = static_cast<std::size_t>(at);
    const auto part = static_cast<float>(at - static_cast<double>(column));
    factor[i] = shade_[column] + (shade_[column + 1] - shade_[column]) * part;
  }
  static_cast<void>(y);
  return true;
}

}  // namespace freshet::synth::scene
