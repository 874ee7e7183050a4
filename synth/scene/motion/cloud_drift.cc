#include "synth/scene/motion/cloud_drift.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace freshet::synth::scene {
namespace {

constexpr double kUsual = 0.006;      // of the picture's width, for each m/s
constexpr double kComesRound = 0.75;  // of a period: from there on a loop's clouds go round

}  // namespace

CloudDrift::CloudDrift(const CloudMotion& clouds, const Wind& wind, const Cycle& cycle, bool loop,
                       double period_px, const cv::Range& rows, int picture_width)
    : cycle_(cycle), rows_(rows), far_speed_(clouds.far_speed) {
  const double along = std::cos(wind.direction_deg * std::numbers::pi / 180);
  speed_ = clouds.speed_px_per_s.value_or(kUsual * picture_width * wind.speed_m_per_s * along);
  if (!loop) return;
  const double rounds = speed_ * cycle.seconds() / period_px;
  mixes_ = std::abs(rounds) < kComesRound || far_speed_ != 1;
  if (!mixes_) speed_ = std::round(rounds) * period_px / cycle.seconds();
}

void CloudDrift::go_to(int frame) {
  const int place = cycle_.place(frame);
  gone_[0] = speed_ * place / cycle_.fps;
  gone_[1] = speed_ * (place - cycle_.frames) / cycle_.fps;
  second_ = mixes_ && speed_ != 0 ? static_cast<float>(place) / static_cast<float>(cycle_.frames) : 0;
  reach_ = static_cast<float>(std::max(std::abs(gone_[0]), second_ > 0 ? std::abs(gone_[1]) : 0.0)) + 1;
}

void CloudDrift::row(int copy, int, int y, int n, float* dx, float* dy) const {
  const double down = std::clamp((y - rows_.start) / std::max(1.0, rows_.size() - 1.0), 0.0, 1.0);
  const double speed = 1 + (far_speed_ - 1) * down;
  std::fill(dx, dx + n, static_cast<float>(-gone_[copy] * speed));
  std::fill(dy, dy + n, 0.0f);
}

}  // namespace freshet::synth::scene
