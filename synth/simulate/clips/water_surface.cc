// synth/simulate/clips/water_surface.cc — waves under a low sun, and rain on a pool, seen over the water.
//
// No solver: a height field of plane waves, each at the speed that deep water gives its length (w^2 = g k), and of
// rings where drops fall. Slopes are exact, so glitter is where the sun's mirror image is.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/grid.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/noise.h"

namespace freshet::synth::simulate {
namespace {

/// Lengths are in heights of the picture, as seen on the water at its lower border.
struct Wave {
  float kx, kz;     // turns per length
  float turns;      // per second
  float steepness;  // slope at its steepest
  float phase;      // turns
};
struct Ring {
  float x, z, age_s;
};
struct Direction {
  float x, y, z;
};
float dot(Direction a, Direction b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Direction unit(Direction a) {
  const float length = std::sqrt(dot(a, a));
  return {a.x / length, a.y / length, a.z / length};
}

class WaterSurface final : public Scene {
 public:
  explicit WaterSurface(const SceneOptions& options)
      : size_(options.size),
        noise_(options.seed),
        second_(1.0f / static_cast<float>(options.fps)),
        zoom_(options.variation.zoom),
        rain_(options.kind == SceneKind::kRain),
        seed_(options.seed) {
    Random random(options.seed, rain_ ? 110 : 109);
    // Of a pool one sees the near water alone, of a sea often the horizon.
    horizon_ = rain_ ? -random.between(0.5f, 1.0f) : random.between(-0.5f, 0.3f);
    camera_ = 1.0f - horizon_;
    const float gravity = random.between(1.6f, 2.6f) * zoom_;
    const float wind =
        random.between(-0.12f, 0.12f) + (random.sign() > 0 ? 0.25f : -0.25f);  // turns from away
    const float longest = (rain_ ? 0.25f : random.between(0.5f, 0.9f)) * zoom_;
    const float slope = (rain_ ? 0.02f : random.between(0.05f, 0.08f) * options.variation.amount);
    for (std::size_t i = 0; i < waves_.size(); ++i) {
      const float part = static_cast<float>(i) / static_cast<float>(waves_.size() - 1);
      const float length = longest * exp2_portable(-5.0f * part) * random.between(0.9f, 1.1f);
      // The shorter a wave, the wider it strays from the wind.
      const float way = wind + random.between(-0.5f, 0.5f) * (0.10f + 0.30f * part);
      const float k = 1.0f / length;
      waves_[i] = {.kx = k * sin_turns(way),
                   .kz = -k * cos_turns(way),
                   .turns = std::sqrt(gravity * k / (2.0f * kPi)),
                   .steepness = slope * (1.0f - 0.4f * part) * random.between(0.6f, 1.0f),
                   .phase = random.next()};
    }
    drops_per_s_ = rain_ ? random.between(150.0f, 240.0f) * options.variation.amount : 0.0f;
    ring_length_ = 0.06f * zoom_;
    ring_speed_ = 0.4f * zoom_;
    const float kind = random.next();  // noon, evening or a grey day
    low_sky_ = kind < 0.4f    ? Rgb{0.55f, 0.66f, 0.80f}
               : kind < 0.75f ? Rgb{0.85f, 0.50f, 0.30f}
                              : Rgb{0.5f, 0.52f, 0.55f};
    high_sky_ = kind < 0.4f    ? Rgb{0.10f, 0.22f, 0.48f}
                : kind < 0.75f ? Rgb{0.16f, 0.17f, 0.30f}
                               : Rgb{0.25f, 0.28f, 0.33f};
    deep_ = mix(Rgb{0.004f, 0.03f, 0.05f}, Rgb{0.02f, 0.07f, 0.06f}, random.next());
    sun_ = unit({random.between(-0.35f, 0.35f), random.between(0.25f, 0.6f), 1.0f});
    sunlight_ = rain_ ? 0.0f : kind < 0.75f ? random.between(2.0f, 5.0f) : 0.3f;
  }

  FilmOptions film() const override { return {.exposure = 0.9f, .bloom = 0.05f}; }
  int warm_up_frames() const override { return 0; }
  void advance() override { ++clock_; }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    const float now = second_ * static_cast<float>(clock_);
    const std::vector<Ring> rings = rings_at(now);
    const float w = static_cast<float>(size_.width), h = static_cast<float>(size_.height);
    for_rows(size_.height, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const float below = (static_cast<float>(y) + 0.5f) / h - horizon_;
      if (below < 2.0f / h) {
        const Rgb sky = mix(low_sky_, high_sky_, smoothstep(0.0f, 0.8f, -below));
        for (int x = 0; x < size_.width; ++x) out[x] = sky, a[x] = 0, m[x] = {};
        return;
      }
      const float away = camera_ / below;  // 1 at the lower border
      const float z = kFocal * away, footprint_x = away / h, footprint_z = z / (below * h);
      std::array<float, kWaves> seen;
      Vec2 carried{};
      float weight = 0.0f;
      for (std::size_t i = 0; i < waves_.size(); ++i) {
        const Wave& wave = waves_[i];
        const float blur_x = wave.kx * footprint_x, blur_z = wave.kz * footprint_z;
        seen[i] = wave.steepness * exp_portable(-8.0f * (blur_x * blur_x + blur_z * blur_z));
        const float k2 = wave.kx * wave.kx + wave.kz * wave.kz;
        carried.x += seen[i] * wave.turns * wave.kx / k2, carried.y += seen[i] * wave.turns * wave.kz / k2;
        weight += seen[i];
      }
      // Waves come with + k x - w t: they go along k.
      carried = weight > 0.0f ? Vec2{carried.x / weight, carried.y / weight} : Vec2{};
      for (int x = 0; x < size_.width; ++x) {
        const float side = ((static_cast<float>(x) + 0.5f - 0.5f * w) / h);
        const float px = side * away;
        const float drift = 0.35f * noise_(1.3f * px / zoom_ + 5.0f, 0.9f * z / zoom_ + 0.03f * now);
        float sx = 0.0f, sz = 0.0f, height = 0.0f;
        for (std::size_t i = 0; i < waves_.size(); ++i) {
          if (seen[i] < 1e-4f) continue;
          const Wave& wave = waves_[i];
          const float turns = wave.kx * px + wave.kz * z - wave.turns * now + wave.phase + drift;
          const float k = std::sqrt(wave.kx * wave.kx + wave.kz * wave.kz),
                      slope = seen[i] * cos_turns(turns);
          sx += slope * wave.kx / k, sz += slope * wave.kz / k;
          height += seen[i] * sin_turns(turns);
        }
        float splash = 0.0f;
        for (const Ring& ring : rings) splash += lift(ring, px, z, sx, sz);
        const Direction up = unit({-sx, 1.0f, -sz}), eye = unit({-px, camera_, -z});
        const float facing = std::clamp(dot(up, eye), 0.03f, 1.0f);
        const Direction mirrored{2.0f * facing * up.x - eye.x, 2.0f * facing * up.y - eye.y,
                                 2.0f * facing * up.z - eye.z};
        const float one_less = 1.0f - facing, squared = one_less * one_less;
        const float fresnel = 0.02f + 0.98f * squared * squared * one_less;
        const Rgb sky = mix(low_sky_, high_sky_, smoothstep(0.0f, 0.7f, mirrored.y));
        const float glint = sunlight_ * exp_portable(-260.0f * (1.0f - dot(mirrored, sun_)));
        const Rgb body = deep_ * std::clamp(1.0f + 3.0f * height, 0.4f, 2.2f);
        out[x] = mix(body, sky, fresnel) + Rgb{1.0f, 0.93f, 0.82f} * (glint + 0.8f * std::min(splash, 1.0f));
        a[x] = 255;
        const float z_later = z + carried.y * second_, x_later = px + carried.x * second_;
        const float scale = kFocal / std::max(z_later, 0.05f);
        m[x] = {(x_later * scale - side) * h, (camera_ * scale - below) * h};
      }
    });
  }

 private:
  static constexpr std::size_t kWaves = 26;
  static constexpr float kFocal = 1.4f, kRingLife_s = 0.9f;

  /// Drops fall in slots of their own, each in its own time; where, its turn says.
  std::vector<Ring> rings_at(float now) const {
    const Random random(seed_, 111);
    const int slots = static_cast<int>(drops_per_s_ * kRingLife_s);
    const float aspect = static_cast<float>(size_.width) / static_cast<float>(size_.height);
    std::vector<Ring> rings;
    for (int i = 0; i < slots; ++i) {
      const float turns = now / kRingLife_s + random.at(static_cast<std::uint64_t>(i)) + 1.0f;
      const int turn = floor_int(turns);
      const std::uint64_t draw =
          (static_cast<std::uint64_t>(turn) << 24) + static_cast<std::uint64_t>(i) * 2 + (1u << 20);
      // Spread evenly over the picture, that is: thinner where the water is near.
      const float below = random.at(draw + 1) - horizon_, away = camera_ / below;
      rings.push_back({(random.at(draw) - 0.5f) * aspect * away, kFocal * away,
                       kRingLife_s * (turns - static_cast<float>(turn))});
    }
    return rings;
  }

  /// Adds a ring's slope; returns the light of the splash itself.
  float lift(const Ring& ring, float x, float z, float& sx, float& sz) const {
    const float reach = ring_speed_ * ring.age_s + 2.5f * ring_length_;
    const float dx = x - ring.x, dz = z - ring.z;
    if (std::fabs(dx) > reach || std::fabs(dz) > reach) return 0.0f;
    const float r = std::sqrt(dx * dx + dz * dz) + 1e-4f, at = (r - ring_speed_ * ring.age_s) / ring_length_;
    const float fading = (1.0f - ring.age_s / kRingLife_s) * exp_portable(-2.2f * ring.age_s);
    const float slope = 0.8f * fading * cos_turns(at) * exp_portable(-0.5f * at * at);
    sx += slope * dx / r, sz += slope * dz / r;
    const float drop = r / (0.25f * ring_length_);
    return ring.age_s < 0.06f ? exp_portable(-drop * drop) : 0.0f;
  }

  cv::Size size_;
  Noise noise_;
  float second_, zoom_;  // seconds of a frame
  bool rain_;
  std::uint64_t seed_;
  float horizon_, camera_;  // of the picture's height from above; heights above the water
  std::array<Wave, kWaves> waves_;
  float drops_per_s_, ring_length_, ring_speed_;
  Rgb low_sky_, high_sky_, deep_;
  Direction sun_;
  float sunlight_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_sea(const SceneOptions& options) {
  return std::make_unique<WaterSurface>(options);
}
std::unique_ptr<Scene> make_rain(const SceneOptions& options) {
  return std::make_unique<WaterSurface>(options);
}

}  // namespace freshet::synth::simulate
