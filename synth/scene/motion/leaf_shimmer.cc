#include "synth/scene/motion/leaf_shimmer.h"

#include <algorithm>
#include <cmath>

#include "platform/random.h"

namespace freshet::synth::scene {
namespace {

constexpr double kLeafHz = 2.5, kLeafDampingPerS = 8;

}  // namespace

LeafShimmer::LeafShimmer(const TreeMotion& tree, const Gusts& gusts, const Cycle& cycle, std::uint64_t seed,
                         const cv::Rect& region)
    : frames_(cycle.frames), region_(region), seed_(seed) {
  const Wind& strongest = gusts.weather().strongest();
  if (!(tree.shimmer_px > 0) || !(strongest.speed_m_per_s > 0) || !(strongest.turbulence > 0)) return;
  if (gusts.weather().changes()) {
    for (int t = 0; t < cycle.frames; ++t)
      share_.push_back(
          static_cast<float>(gusts.weather().at_frame(t).speed_m_per_s / strongest.speed_m_per_s));
  }
  const Gusts steady = gusts.steady();
  size_px_ = tree.shimmer_size_px;
  for (std::uint64_t i = 0; i < kSeries; ++i) {
    std::vector<float>& values = series_[i];
    values = series(oscillator(steady.force(region.x + 0.5 * region.width, {1, 0}, 7777 + 64 * seed + i),
                               cycle, kLeafHz, kLeafDampingPerS),
                    cycle);
    double square = 0;
    for (const float v : values) square += static_cast<double>(v) * v;
    const auto scale =
        static_cast<float>(tree.shimmer_px / std::sqrt(std::max(square / cycle.frames, 1e-20)));
    for (float& v : values) {
      v *= scale;
      reach_ = std::max(reach_, std::abs(v));
    }
  }
  nodes_.create(static_cast<int>(region.height / size_px_) + 5, static_cast<int>(region.width / size_px_) + 5,
                CV_32FC2);
}

void LeafShimmer::go_to(int place) {
  if (nodes_.empty()) return;
  const float share = share_.empty() ? 1 : share_[static_cast<std::size_t>(place)];
  for (int r = 0; r < nodes_.rows; ++r) {
    auto* out = nodes_.ptr<cv::Point2f>(r);
    for (int c = 0; c < nodes_.cols; ++c) {
      const std::uint64_t draw = scramble(seed_ * 0x10001 + static_cast<std::uint64_t>(r * nodes_.cols + c));
      const auto value = [&](int shift) {
        const auto which = (draw >> shift) % kSeries;
        const auto delay = (draw >> (shift + 8)) % static_cast<std::uint64_t>(frames_);
        return series_[which]
                      [(static_cast<std::uint64_t>(place) + delay) % static_cast<std::uint64_t>(frames_)];
      };
      out[c] = cv::Point2f(value(0), value(32)) * share;
    }
  }
}

void LeafShimmer::add_row(int x, int y, int n, float* dx, float* dy) const {
  if (nodes_.empty()) return;
  // A cubic B-spline: smooth, and never beyond the nodes' values.
  const auto weights = [](float t, float* w) {
    w[0] = (1 - t) * (1 - t) * (1 - t) / 6;
    w[1] = (3 * t * t * t - 6 * t * t + 4) / 6;
    w[3] = t * t * t / 6;
    w[2] = 1 - w[0] - w[1] - w[3];
  };
  const double down = std::clamp((y - region_.y) / size_px_, 0.0, nodes_.rows - 4.001);
  const int top = static_cast<int>(down);
  float wy[4];
  weights(static_cast<float>(down - top), wy);
  const cv::Point2f* rows[4];
  for (int j = 0; j < 4; ++j) rows[j] = nodes_.ptr<cv::Point2f>(top + j);
  for (int i = 0; i < n; ++i) {
    const double right = std::clamp((x + i - region_.x) / size_px_, 0.0, nodes_.cols - 4.001);
    const int left = static_cast<int>(right);
    float wx[4];
    weights(static_cast<float>(right - left), wx);
    cv::Point2f sum(0, 0);
    for (int j = 0; j < 4; ++j)
      for (int k = 0; k < 4; ++k) sum += rows[j][left + k] * (wy[j] * wx[k]);
    dx[i] += sum.x;
    dy[i] += sum.y;
  }
}

}  // namespace freshet::synth::scene
