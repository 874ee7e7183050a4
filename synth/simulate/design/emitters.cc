#include "synth/simulate/design/emitters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "synth/field/portable_math.h"
#include "synth/simulate/design/shape.h"

namespace freshet::synth::simulate {

Emitters::Emitters(const std::vector<Emitter>& emitters, std::vector<float> phases, const Stage& stage)
    : emitters_(emitters), phases_(std::move(phases)) {
  for (const Emitter& emitter : emitters) {
    placed_.emplace_back(emitter.shape, stage.picture, stage.cells);
    grow_ |= emitter.expansion > 0.0f;
  }
}

// How much of its rate an emitter gives now; 0 when it is off.
float Emitters::rate(std::size_t i, const Stage& stage) const {
  const Emitter& emitter = emitters_[i];
  return emitter.span.holds(stage.clock_s) ? std::max(0.0f, value_at(emitter.rate, stage.clock_s)) : 0.0f;
}

void Emitters::feed(const Stage& stage, Grid& density, Grid& heat) {
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const float now = rate(i, stage);
    if (now <= 0.0f) continue;
    placed_[i].place(stage.clock_s);
    feed_density(i, now, stage, density);
    if (emitters_[i].heat > 0.0f) feed_heat(i, now, stage, heat);
  }
}

// Lumps of driven fluid change across its way and with time, never along it: what passes through the shape takes the
// most of what it meets in a few steps, which would show as scallops one step apart.
void Emitters::feed_density(std::size_t i, float rate, const Stage& stage, Grid& density) const {
  const Emitter& emitter = emitters_[i];
  const Noise& noise = stage.noise;
  const float pitch = 1.0f / (emitter.lump * static_cast<float>(stage.picture.height));
  const Vec2 v = emitter.velocity;
  const float speed = std::sqrt(v.x * v.x + v.y * v.y), time = stage.noise_time();
  const float boil =
      time * std::min(1.0f + 0.7f * speed / emitter.lump, 0.25f * static_cast<float>(stage.fps));
  const Vec2 across = speed > 0.0f ? Vec2{-v.y / speed * pitch, v.x / speed * pitch} : Vec2{};
  const auto lump_at = [&](int x, int y) {
    const float px = static_cast<float>(x), py = static_cast<float>(y);
    const float n = speed > 0.0f ? noise.fractal(px * across.x + py * across.y + phases_[i], boil, 2)
                                 : noise.changing(px * pitch + phases_[i], py * pitch - phases_[i], boil, 2);
    return std::clamp(1.0f + emitter.jitter * (1.6f * n - 0.2f), 0.25f, 1.6f);
  };
  const cv::Rect& b = placed_[i].bounds();
  for_rows(b.height, [&](int row) {
    const int y = b.y + row;
    const float* c = placed_[i].coverage().row(y);
    float* p = density.row(y);
    for (int x = b.x; x < b.x + b.width; ++x) {
      if (c[x] <= 0.0f) continue;
      const float lump = emitter.jitter > 0.0f ? lump_at(x, y) : 1.0f;
      p[x] = std::max(p[x], rate * c[x] * lump);
    }
  });
}

void Emitters::feed_heat(std::size_t i, float rate, const Stage& stage, Grid& heat) const {
  const Emitter& emitter = emitters_[i];
  const float gust = 1.0f + emitter.jitter * stage.noise(1.3f * stage.noise_time(), phases_[i] + 4.5f);
  const float given = emitter.heat * std::min(rate, 1.0f) * std::max(0.0f, gust);
  for (std::size_t k = 0; k < heat.values.size(); ++k)
    heat.values[k] = std::max(heat.values[k], given * placed_[i].cell_coverage().values[k]);
}

void Emitters::drive(const Stage& stage, const VectorGrid& velocity, const GridOf<std::uint8_t>& solid,
                     VectorGrid& force, Grid& growth) const {
  if (grow_) std::fill(growth.values.begin(), growth.values.end(), 0.0f);
  const float unit = stage.speed_unit(), time = stage.noise_time();
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    const float now = rate(i, stage);
    if (now <= 0.0f) continue;
    const Emitter& e = emitters_[i];
    const float gust = 1.0f + 0.6f * e.jitter * stage.noise(1.7f * time, phases_[i] + 0.5f),
                sway = 0.06f * e.jitter * stage.noise(1.1f * time, phases_[i] + 20.5f);
    const float s = sin_turns(sway), c = cos_turns(sway);
    const Vec2 asked{unit * gust * (c * e.velocity.x - s * e.velocity.y),
                     unit * gust * (s * e.velocity.x + c * e.velocity.y)};
    const bool driven = e.velocity.x != 0.0f || e.velocity.y != 0.0f;
    const float grown = e.expansion * stage.step_s * std::min(now, 1.0f);
    for_rows(force.height, [&](int y) {
      for (int x = 0; x < force.width; ++x) {
        const float fraction = placed_[i].cell_coverage()(x, y);
        if (fraction <= 0.0f) continue;
        const Vec2 v = velocity(x, y);
        if (driven) {
          force(x, y).x += fraction * (asked.x - v.x);
          force(x, y).y += fraction * (asked.y - v.y);
        }
        if (grown > 0.0f && solid(x, y) == 0) growth(x, y) += grown * fraction;
      }
    });
  }
}

void Emitters::show(const Stage& stage, cv::Mat& shown) const {
  shown.setTo(0);
  for (std::size_t i = 0; i < placed_.size(); ++i) {
    if (rate(i, stage) <= 0.0f) continue;
    const PlacedShape& placed = placed_[i];
    const cv::Rect& b = placed.bounds();
    for (int y = b.y; y < b.y + b.height; ++y) {
      std::uint8_t* out = shown.ptr<std::uint8_t>(y);
      for (int x = b.x; x < b.x + b.width; ++x)
        out[x] = std::max(out[x], static_cast<std::uint8_t>(255.0f * placed.coverage()(x, y) + 0.5f));
    }
  }
}

}  // namespace freshet::synth::simulate
