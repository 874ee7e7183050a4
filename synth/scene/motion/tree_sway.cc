#include "synth/scene/motion/tree_sway.h"

#include <algorithm>
#include <cmath>

#include "platform/vectors.h"

namespace freshet::synth::scene {
namespace {

constexpr float kNearPx2 = 16;  // added to squared distances from armatures
// rad. Eq. 4's spring is linear, and stems in a storm are not: beyond kEasy they give way to the wind less and less, to
// kMostTurn at most. Lines that lie side by side would tear what is between them.
constexpr float kEasy = 0.25f, kMostTurn = 0.4f;
constexpr float kMostScaled = 0.5f;

float distance2_to(cv::Point2f p, cv::Point2f from, cv::Point2f way, float length) {
  const float along = std::clamp((p - from).dot(way), 0.0f, length);
  const cv::Point2f off = p - (from + way * along);
  return off.dot(off);
}

/// Half of how far the lines of a stand lie from their next ones, squared: sway goes over from one to the next all
/// along the way between them, or it would fold what is there.
float between2(const std::vector<Line>& lines) {
  double sum = 0;
  for (const Line& line : lines) {
    double least = 1e9;
    for (const Line& other : lines)
      if (&other != &line) least = std::min(least, cv::norm(line.from + line.to - other.from - other.to) / 2);
    sum += least;
  }
  const auto half = static_cast<float>(0.5 * sum / static_cast<double>(lines.size()));
  return half * half;
}

float given_way(float turn) {
  constexpr float kMore = kMostTurn - kEasy;
  const float size = std::abs(turn);
  return size <= kEasy ? turn : std::copysign(kEasy + kMore * std::tanh((size - kEasy) / kMore), turn);
}

/// out[i] between the grid's values, `columns` of them, at first + i px.
FRESHET_WIDE void interpolate(const float* upper, const float* lower, float down, int first, int columns,
                              int n, float* dx, float* dy) {
  constexpr float kInverse = 1.0f / TreeSway::kStep;
  for (int i = 0; i < n; ++i) {
    int at = first + i;
    at = at > 0 ? at : 0;
    int cell = at / TreeSway::kStep;
    cell = cell < columns - 2 ? cell : columns - 2;
    const float right = static_cast<float>(at - cell * TreeSway::kStep) * kInverse;
    const float *a = upper + 2 * cell, *b = lower + 2 * cell;
    const float top_x = a[0] + (a[2] - a[0]) * right, low_x = b[0] + (b[2] - b[0]) * right;
    const float top_y = a[1] + (a[3] - a[1]) * right, low_y = b[1] + (b[3] - b[1]) * right;
    dx[i] = top_x + (low_x - top_x) * down;
    dy[i] = top_y + (low_y - top_y) * down;
  }
}

}  // namespace

double bend(double u) { return u <= 1 ? ((u / 3 - 4.0 / 3) * u + 2) * u * u : 1 + 4.0 / 3 * (u - 1); }

float bend_by_distance(float u) {
  return u <= 1 ? ((u * (1.0f / 3) - 4.0f / 3) * u + 2) * u : 4.0f / 3 - (1.0f / 3) / u;
}

TreeSway::TreeSway(const TreeMotion& tree, const Gusts& gusts, const Cycle& cycle, std::uint64_t seed,
                   const cv::Rect& region)
    : tree_(tree), cycle_(cycle), region_(region), shimmer_(tree, gusts, cycle, seed, region) {
  std::uint64_t number = 0;
  for (const Line& line : tree.armatures) {
    const cv::Point2d way = line.to - line.from;
    const double length = std::hypot(way.x, way.y);
    Branch branch{.root = line.from,
                  .tip_at = line.to,
                  .way = way * (1 / length),
                  .length = static_cast<float>(length),
                  .tip = {},
                  .lean = {},
                  .towards = {}};
    const cv::Point2d side(-branch.way.y, branch.way.x);
    const std::uint64_t stream = 1000 * seed + (tree.stand ? 0 : 2 * number++);
    const auto swing = [&](Harmonics force) {
      for (std::complex<double>& f : force) f /= tree.mass;
      return series(oscillator(force, cycle, tree.frequency_hz, tree.damping_per_s), cycle);
    };
    branch.tip = swing(gusts.force(line.to.x, side, stream));
    if (tree.foreshortening > 0) branch.towards = swing(gusts.force_towards(line.to.x, stream + 1));
    if (gusts.weather().changes()) {
      branch.lean = swing(gusts.mean_force(side));
      const std::vector<float> towards = swing(gusts.mean_force_towards());
      for (std::size_t t = 0; t < branch.towards.size(); ++t) branch.towards[t] += towards[t];
    }
    branches_.push_back(std::move(branch));
  }
  const cv::Size cells(region.width / kStep + 2, region.height / kStep + 2);
  grid_.create(cells, CV_32FC2);
  if (branches_.size() < 2) return;
  const int count = static_cast<int>(branches_.size());
  const float apart2 = std::max(kNearPx2, between2(tree.armatures));  // some lie in one place
  weights_.create(cells.height, cells.width * count, CV_32F);
  for (int r = 0; r < cells.height; ++r) {
    for (int c = 0; c < cells.width; ++c) {
      const cv::Point2f p(region.x + c * kStep + 0.5f, region.y + r * kStep + 0.5f);
      float* weight = weights_.ptr<float>(r) + c * count;
      float sum = 0;
      for (int b = 0; b < count; ++b) {
        const Branch& branch = branches_[static_cast<std::size_t>(b)];
        const float d2 = distance2_to(p, branch.root, branch.way, branch.length);
        const float near = 1 / (d2 + (tree.stand ? apart2 : kNearPx2));
        sum += weight[b] = tree.stand ? near : near * near;
      }
      for (int b = 0; b < count; ++b) weight[b] /= sum;
    }
  }
}

cv::Point2f TreeSway::source(const Branch& branch, cv::Point2f p, int frame) const {
  cv::Point2f from_root = p - branch.root;
  if (!branch.towards.empty()) {
    const float near =
        branch.towards[static_cast<std::size_t>(frame)] * static_cast<float>(tree_.foreshortening);
    const float scale = std::clamp(1 + near, 1 - kMostScaled, 1 + kMostScaled);
    from_root += branch.way * (from_root.dot(branch.way) * (1 / scale - 1));
  }
  const float distance = std::sqrt(from_root.dot(from_root));
  const float asked =
      bend_by_distance(distance / branch.length) * branch.tip[static_cast<std::size_t>(frame)];
  float turn = given_way(asked);
  if (!branch.lean.empty()) {
    const float lean =
        bend_by_distance(distance / branch.length) * branch.lean[static_cast<std::size_t>(frame)];
    turn += kMostLean * std::tanh(lean / kMostLean);
  }
  // Back: the tip goes to the right of its way for what is positive, which turns clockwise as y points down.
  const float c = std::cos(turn), s = std::sin(turn);
  return branch.root + cv::Point2f(from_root.x * c + from_root.y * s, from_root.y * c - from_root.x * s);
}

void TreeSway::go_to(int frame) {
  const int t = cycle_.place(frame), count = static_cast<int>(branches_.size());
  shimmer_.go_to(t);
  float reach = 0;
  for (int r = 0; r < grid_.rows; ++r) {
    auto* out = grid_.ptr<cv::Point2f>(r);
    for (int c = 0; c < grid_.cols; ++c) {
      const cv::Point2f p(region_.x + c * kStep + 0.5f, region_.y + r * kStep + 0.5f);
      cv::Point2f moved(0, 0);
      if (count == 1) moved = source(branches_[0], p, t) - p;
      for (int b = 0; b < count && count > 1; ++b)
        moved +=
            (source(branches_[static_cast<std::size_t>(b)], p, t) - p) * weights_.at<float>(r, c * count + b);
      out[c] = moved;
      reach = std::max({reach, std::abs(moved.x), std::abs(moved.y)});
    }
  }
  reach_ = reach + shimmer_.reach();
}

void TreeSway::row(int, int x, int y, int n, float* dx, float* dy) const {
  const int below = std::max(0, y - region_.y), cell = std::min(below / kStep, grid_.rows - 2);
  interpolate(grid_.ptr<float>(cell), grid_.ptr<float>(cell + 1),
              static_cast<float>(below - cell * kStep) / kStep, x - region_.x, grid_.cols, n, dx, dy);
  shimmer_.add_row(x, y, n, dx, dy);
}

}  // namespace freshet::synth::scene
