// synth/simulate/clips/breakers.cc — waves that come in to a beach, break, run up the sand and drain off it, seen from
// there.
//
// Long waves by the shallow-water equations; foam is made where they break, is carried along, and thins out into lace.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/clips/carried_texture.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/noise.h"
#include "synth/simulate/solver/shallow_water.h"

namespace freshet::synth::simulate {
namespace {

/// Lengths are in heights of the picture, as seen on the water at its lower border; z is away from the camera.
constexpr float kFocal = 1.4f, kNearest = 1.1f, kFarthest = 13.0f, kCell = 0.045f;
constexpr float kMakerLength = 0.8f;  // of the water at the far end where waves are made

/// A train of long waves from far out.
struct Swell {
  float kx, kz;  // turns per length
  float turns;   // per second
  float height;  // of its crests
  float phase;   // turns
  float k;       // length of (kx, kz)
};

class Breakers final : public Scene {
 public:
  explicit Breakers(const SceneOptions& options)
      : size_(options.size),
        noise_(options.seed),
        second_(1.0f / static_cast<float>(options.fps)),
        zoom_(options.variation.zoom),
        random_(options.seed, 112),
        horizon_(random_.between(0.06f, 0.24f)),
        camera_(1.0f - horizon_),
        gravity_(random_.between(1.7f, 2.4f) * zoom_),
        shore_(kNearest + random_.between(0.3f, 1.5f)),
        far_depth_(depth_at(kFarthest)),
        celerity_(std::sqrt(gravity_ * far_depth_)),
        water_(make_bed(), {.cell = kCell, .gravity = gravity_, .friction = 0.012f}),
        foam_(water_.depth().width, water_.depth().height),
        carried_(foam_),
        wet_(foam_),
        back_(foam_.width, foam_.height),
        texture_(foam_.width, foam_.height, std::max(8, static_cast<int>(1.6f / second_)), 0),
        seen_(size_.width, size_.height) {
    const float period = random_.between(2.6f, 3.8f) * std::sqrt(zoom_);
    const float slant = random_.between(-0.05f, 0.05f);  // turns off straight in
    for (std::size_t i = 0; i < swells_.size(); ++i) {
      const float way = slant + random_.between(-0.035f, 0.035f);
      const float turns = (0.8f + 0.2f * static_cast<float>(i)) * random_.between(0.95f, 1.05f) / period;
      const float k = turns / celerity_;
      Swell& swell = swells_[i];
      swell = {.kx = k * sin_turns(way),
               .kz = -k * cos_turns(way),
               .turns = turns,
               .height = 0.08f * zoom_ * options.variation.amount * random_.between(0.5f, 1.0f),
               .phase = random_.next(),
               .k = 0.0f};
      swell.k = std::sqrt(swell.kx * swell.kx + swell.kz * swell.kz);
    }
    const float kind = random_.next();  // noon, evening or a grey day
    low_sky_ = kind < 0.5f   ? Rgb{0.60f, 0.72f, 0.85f}
               : kind < 0.7f ? Rgb{0.85f, 0.58f, 0.38f}
                             : Rgb{0.58f, 0.60f, 0.62f};
    high_sky_ = kind < 0.5f   ? Rgb{0.12f, 0.26f, 0.52f}
                : kind < 0.7f ? Rgb{0.20f, 0.20f, 0.32f}
                              : Rgb{0.30f, 0.33f, 0.37f};
    deep_ = mix(Rgb{0.01f, 0.07f, 0.09f}, Rgb{0.03f, 0.10f, 0.08f}, random_.next());
    through_ = mix(Rgb{0.05f, 0.30f, 0.30f}, Rgb{0.16f, 0.28f, 0.20f}, random_.next());
    sand_ = mix(Rgb{0.46f, 0.38f, 0.27f}, Rgb{0.30f, 0.26f, 0.21f}, random_.next());
    start();
  }

  FilmOptions film() const override { return {.exposure = 0.9f, .bloom = 0.04f}; }
  int warm_up_frames() const override { return static_cast<int>(5.0f / second_); }

  void advance() override {
    ++clock_;
    float left = second_;
    while (left > 0.0f) {
      const float seconds = std::min(left, water_.longest_step());
      water_.step(seconds);
      left -= seconds;
      make_waves(second_ * static_cast<float>(clock_) - left);
    }
    carry_foam();
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    find_surface();
    const float w = static_cast<float>(size_.width), h = static_cast<float>(size_.height);
    for_rows(size_.height, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const float from_top = (static_cast<float>(y) + 0.5f) / h;
      for (int x = 0; x < size_.width; ++x) {
        const float z = seen_(x, y);
        if (z <= 0.0f) {
          out[x] = mix(low_sky_, high_sky_, smoothstep(0.0f, 0.8f, horizon_ - from_top));
          a[x] = 0, m[x] = {};
          continue;
        }
        const float side = (static_cast<float>(x) + 0.5f - 0.5f * w) / h, px = side * z / kFocal;
        const Place place = place_at(px, z);
        out[x] = lit(place, px, z);
        a[x] = static_cast<std::uint8_t>(255.0f * place.wet + 0.5f);
        m[x] = {};
        if (a[x] == 0) continue;
        const float later_x = px + place.velocity.x * second_,
                    later_z = std::max(0.5f, z + place.velocity.y * second_);
        m[x] = {(later_x * kFocal / later_z - side) * h,
                (kFocal * (camera_ - place.height) * (1.0f / later_z - 1.0f / z)) * h};
      }
    });
  }

 private:
  /// What is seen at a place of the water or the beach.
  struct Place {
    float height, depth, foam, wet, slope_x, slope_z;
    Vec2 velocity;
    float cx, cz;  // cells
  };

  float half_width() const {
    const float aspect = static_cast<float>(size_.width) / static_cast<float>(size_.height);
    return std::min(0.5f * aspect * kFarthest / kFocal + 0.3f, 16.0f);
  }
  /// Of still water: a beach as waves leave one (Dean 1991), and sand above it.
  float depth_at(float z) const {
    const float out = (z - shore_) / zoom_;
    return zoom_ * (out > 0.0f ? 0.085f * pow_portable(out, 0.6667f) : 0.075f * out);
  }
  Grid make_bed() const {
    Grid bed(std::max(8, static_cast<int>(2.0f * half_width() / kCell)),
             static_cast<int>((kFarthest - kNearest) / kCell));
    for (int y = 0; y < bed.height; ++y) {
      for (int x = 0; x < bed.width; ++x) {
        const float px = (static_cast<float>(x) + 0.5f) * kCell - half_width(),
                    z = kNearest + kCell * static_cast<float>(y);
        // Bars and rips: waves break here before they do there.
        const float uneven = noise_.fractal(0.35f * px / zoom_ + 3.0f, 0.5f * z / zoom_, 2);
        const float depth = depth_at(z);
        bed(x, y) = -depth * (1.0f + 0.55f * uneven) + (depth < 0.0f ? 0.0f : 0.012f * zoom_ * uneven);
      }
    }
    return bed;
  }

  float cell_x(float px) const { return (px + half_width()) / kCell - 0.5f; }
  float cell_z(float z) const { return (z - kNearest) / kCell; }

  float surface_far(float px, float z, float now, Vec2& velocity) const {
    float surface = 0.0f;
    velocity = {};
    for (const Swell& swell : swells_) {
      const float rise = swell.height * sin_turns(swell.kx * px + swell.kz * (z - kFarthest) -
                                                  swell.turns * now + swell.phase);
      surface += rise;
      velocity.x += rise * celerity_ / far_depth_ * swell.kx / swell.k,
          velocity.y += rise * celerity_ / far_depth_ * swell.kz / swell.k;
    }
    return surface;
  }

  /// All water moves as the swell would that comes in, lower where it is shallow: nobody waits for the first waves.
  void start() {
    for (int y = 0; y < foam_.height; ++y) {
      for (int x = 0; x < foam_.width; ++x) {
        const float depth = water_.depth()(x, y), z = kNearest + kCell * static_cast<float>(y);
        if (depth <= 0.0f) continue;
        Vec2 v;
        const float surface = surface_far(kCell * (static_cast<float>(x) + 0.5f) - half_width(), z, 0.0f, v);
        const float share = std::min(1.0f, depth / far_depth_);
        water_.pull(x, y, surface * share, {v.x * share, v.y * share}, 1.0f);
      }
    }
  }

  void make_waves(float now) {
    const int length = static_cast<int>(kMakerLength / kCell), last = foam_.height - 1;
    for_rows(length, [&](int i) {
      const float in = static_cast<float>(length - i) / static_cast<float>(length);
      const int y = last - i;
      for (int x = 0; x < foam_.width; ++x) {
        Vec2 v;
        const float surface = surface_far(kCell * (static_cast<float>(x) + 0.5f) - half_width(),
                                          kNearest + kCell * static_cast<float>(y), now, v);
        water_.pull(x, y, surface, v, in * in);
      }
    });
  }

  void carry_foam() {
    const int last_x = foam_.width - 1, last_z = foam_.height - 1;
    const float cells = second_ / kCell;
    for_rows(foam_.height, [&](int y) {
      for (int x = 0; x < foam_.width; ++x) {
        const Vec2 v = water_.velocity()(x, y);
        back_(x, y) = {-v.x * cells, -v.y * cells};
      }
    });
    texture_.advance(back_);
    const float fading = exp_portable(-0.4f * second_ / std::sqrt(zoom_)), dry = 0.12f * second_;
    for_rows(foam_.height, [&](int y) {
      const int near = std::max(y - 1, 0), far = std::min(y + 1, last_z);
      for (int x = 0; x < foam_.width; ++x) {
        const Vec2 b = back_(x, y);
        const int left = std::max(x - 1, 0), right = std::min(x + 1, last_x);
        const VectorGrid& v = water_.velocity();
        const float depth = water_.depth()(x, y);
        float foam = bilinear(foam_, static_cast<float>(x) + b.x, static_cast<float>(y) + b.y) * fading;
        // A front that breaks runs into water that does not make way.
        const float squeezed =
            (v(left, y).x - v(right, y).x + v(x, near).y - v(x, far).y) / (2.0f * kCell) * std::sqrt(zoom_);
        if (depth > 4.0f * water_.thinnest())
          foam += second_ / std::sqrt(zoom_) * 9.0f * std::clamp(squeezed - 0.7f, 0.0f, 2.5f);
        carried_(x, y) = std::min(foam, 1.3f) * (depth > 0.0f ? 1.0f : 1.0f - std::min(1.0f, 2.0f * second_));
        wet_(x, y) = std::max(wetness(depth), wet_(x, y) - dry);
      }
    });
    std::swap(foam_, carried_);
  }

  /// Shown of water: fronts go on within a cell while it fills.
  static float wetness(float depth) { return smoothstep(0.02f * kCell, 0.3f * kCell, depth); }
  float height_at(float cx, float cz) const {
    return bilinear(water_.bed(), cx, cz) + bilinear(water_.depth(), cx, cz);
  }

  /// How far away what each pixel shows is: crests hide what is behind them. 0: sky.
  void find_surface() {
    const float w = static_cast<float>(size_.width), h = static_cast<float>(size_.height);
    const float now = second_ * static_cast<float>(clock_);
    const cv::Size size = size_;
    for_rows(size.width, [&](int x) {
      const float side = (static_cast<float>(x) + 0.5f - 0.5f * w) / h;
      const auto row_of = [&](float z) {
        const float px = side * z / kFocal;
        Vec2 v;
        const float height = z < kFarthest ? height_at(cell_x(px), cell_z(z)) : surface_far(px, z, now, v);
        return (horizon_ + kFocal * (camera_ - height) / z) * h - 0.5f;
      };
      int y = size.height - 1;
      float z = 0.8f, row = row_of(z), lowest = row;
      bool hidden = false;
      while (y >= 0 && z < 400.0f) {
        const float step = std::clamp(0.4f * z * z / (kFocal * camera_ * h), 0.2f * kCell, 0.25f * z);
        const float next = z + step, next_row = row_of(next);
        while (y >= 0 && next_row <= static_cast<float>(y)) {
          const float part = hidden || row <= next_row
                                 ? 1.0f
                                 : std::clamp((row - static_cast<float>(y)) / (row - next_row), 0.0f, 1.0f);
          seen_(x, y) = z + part * step;
          --y;
        }
        hidden = next_row > lowest;
        lowest = std::min(lowest, next_row);
        z = next, row = next_row;
      }
      for (; y >= 0; --y) seen_(x, y) = 0.0f;
    });
  }

  Place place_at(float px, float z) const {
    Place p{};
    p.cx = cell_x(px), p.cz = cell_z(z);
    if (z >= kFarthest) {
      const float now = second_ * static_cast<float>(clock_);
      Vec2 unused;
      p.height = surface_far(px, z, now, p.velocity), p.depth = far_depth_, p.wet = 1.0f;
      p.slope_x = (surface_far(px + 0.1f, z, now, unused) - p.height) / 0.1f;
      p.slope_z = (surface_far(px, z + 0.1f, now, unused) - p.height) / 0.1f;
      return p;
    }
    p.height = height_at(p.cx, p.cz), p.depth = bilinear(water_.depth(), p.cx, p.cz);
    p.foam = bilinear(foam_, p.cx, p.cz);
    p.wet = wetness(p.depth);
    p.velocity = bilinear(water_.velocity(), p.cx, p.cz);
    p.slope_x = (height_at(p.cx + 1.0f, p.cz) - height_at(p.cx - 1.0f, p.cz)) / (2.0f * kCell);
    p.slope_z = (height_at(p.cx, p.cz + 1.0f) - height_at(p.cx, p.cz - 1.0f)) / (2.0f * kCell);
    return p;
  }

  Rgb lit(const Place& p, float px, float z) const {
    const float away = z / kFocal;
    // Ripples and lace that go with the water.
    const float pitch = 3.2f / zoom_, fine = std::clamp(1.6f / away, 0.25f, 1.0f);
    const auto at = [&](Vec2 offset, Vec2 shift) -> Vec2 {
      return {(px + offset.x * kCell) * pitch + shift.x, (z + offset.y * kCell) * pitch + shift.y};
    };
    const float ripple_x = texture_.blended(p.cx, p.cz, [&](Vec2 o, Vec2 s) {
      const Vec2 t = at(o, s);
      return noise_.fractal(1.3f * t.x, 2.1f * t.y, 5, 0.7f);
    });
    const float ripple_z = texture_.blended(p.cx, p.cz, [&](Vec2 o, Vec2 s) {
      const Vec2 t = at(o, s);
      return noise_.fractal(1.1f * t.x + 9.0f, 2.3f * t.y + 4.0f, 5, 0.7f);
    });
    const float lace = texture_.blended(p.cx, p.cz, [&](Vec2 o, Vec2 s) {
      const Vec2 t = at(o, s);
      // Cells with thin walls, as bubbles leave them.
      return 1.0f - 2.2f * std::fabs(noise_.fractal(1.2f * t.x + 5.0f, 1.2f * t.y, 6, 0.6f));
    });
    const float sx = p.slope_x + 0.16f * fine * ripple_x, sz = p.slope_z + 0.16f * fine * ripple_z;
    const float distance = std::sqrt(px * px + z * z + camera_ * camera_);
    const float length = std::sqrt(sx * sx + sz * sz + 1.0f);
    const float facing = std::clamp((px * sx + camera_ + z * sz) / (distance * length), 0.03f, 1.0f);
    const float one_less = 1.0f - facing, squared = one_less * one_less;
    const float mirror = std::min(0.6f, 0.02f + 0.98f * squared * squared * one_less);
    const Rgb sky =
        mix(low_sky_, high_sky_, smoothstep(0.0f, 0.9f, 2.0f * facing / length - camera_ / distance));
    // Light comes through a steep face, and from the sand through shallow water.
    const float face = smoothstep(0.05f, 0.45f, p.slope_z) * (1.0f - 0.5f * one_less);
    const Rgb body = mix(deep_, through_, std::min(1.0f, face + 0.25f));
    const float murk = 1.0f - exp_portable(-9.0f * p.depth / zoom_);
    const float grain = noise_.fractal(14.0f * px, 14.0f * z, 3, 0.7f);
    const float soaked = bilinear(wet_, p.cx, p.cz);
    Rgb sand = sand_ * ((1.0f + 0.14f * grain) * (1.0f - 0.45f * soaked));
    if (z < kFarthest && p.wet < 1.0f) sand = mix(sand, low_sky_, 0.18f * soaked * squared);
    Rgb c = mix(mix(sand, body, murk), sky, mirror * p.wet);
    const float cover =
        smoothstep(0.15f, 0.85f,
                   p.foam * 0.9f + 0.38f * lace * (1.0f - 0.6f * std::min(1.0f, p.foam)) - 0.05f) *
        smoothstep(0.02f, 0.22f, p.foam);
    const float shade = std::clamp(0.78f - 0.9f * sz + 0.4f * sx + 0.22f * lace * p.foam, 0.3f, 1.25f);
    c = mix(c, mix(Rgb{0.95f, 0.97f, 1.0f}, low_sky_, 0.25f) * shade, cover * p.wet);
    const Rgb haze = mix(low_sky_, deep_, 0.35f);
    return mix(c, haze, 1.0f - exp_portable(-0.012f * away * away));
  }

  cv::Size size_;
  Noise noise_;
  float second_, zoom_;  // seconds of a frame
  Random random_;
  float horizon_, camera_, gravity_, shore_;
  float far_depth_, celerity_;  // of the still water where waves are made, and theirs
  ShallowWater water_;
  Grid foam_, carried_, wet_;
  VectorGrid back_;
  CarriedTexture texture_;
  Grid seen_;
  std::array<Swell, 3> swells_;
  Rgb low_sky_, high_sky_, deep_, through_, sand_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_breakers(const SceneOptions& options) {
  return std::make_unique<Breakers>(options);
}

}  // namespace freshet::synth::simulate
