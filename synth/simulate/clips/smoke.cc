// synth/simulate/clips/smoke.cc — smoke that rises from a few vents, lit from one side.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/clips/gas.h"
#include "synth/simulate/scene/simulated_scene.h"

namespace freshet::synth::simulate {
namespace {

struct Vent {
  float x, y, radius;  // px of the domain
  float strength, pulse, phase;
};

class Smoke final : public Scene {
 public:
  explicit Smoke(const SceneOptions& options)
      : noise_(options.seed),
        rate_(25.0f / static_cast<float>(options.fps)),
        gas_(Domain(options, 0.10f, 0.06f, 0.06f), options.variation.zoom, flow_options(), 1,
             std::max(8, static_cast<int>(13.0f / rate_))),
        cells_(gas_.domain.width, gas_.domain.height),
        thick_(options.size.width, options.size.height),
        toward_light_(thick_) {
    Random random(options.seed, 101);
    const Domain& d = gas_.domain;
    const int vents = 1 + random.below(3);
    for (int i = 0; i < vents; ++i) {
      const float fraction =
          (static_cast<float>(i) + random.between(0.25f, 0.75f)) / static_cast<float>(vents);
      vents_.push_back({.x = static_cast<float>(d.left) +
                             (0.1f + 0.8f * fraction) * static_cast<float>(options.size.width),
                        .y = static_cast<float>(d.top) +
                             random.between(0.93f, 1.02f) * static_cast<float>(options.size.height),
                        .radius = d.scale * random.between(14.0f, 30.0f),
                        .strength = random.between(0.75f, 1.1f),
                        .pulse = random.between(0.03f, 0.09f),
                        .phase = random.between(0.0f, 50.0f)});
    }
    buoyancy_ = random.between(0.24f, 0.36f) * rate_ * rate_ * speed_unit();
    terminal_ = random.between(4.4f, 6.4f) * rate_ * speed_unit();
    wind_ = random.sign() * random.between(0.0f, 1.1f) * rate_ * speed_unit();
    gust_ = random.between(0.2f, 0.8f);
    light_ = random.sign() * random.between(0.4f, 0.9f);
    opacity_ = random.between(0.9f, 1.7f) * options.variation.amount;
    detail_ = random.between(0.045f, 0.07f);

    // White steam, grey smoke, or a coloured light on either; always over a dark, still backdrop.
    const float warm = random.between(-1.0f, 1.0f), bright = random.between(0.75f, 1.15f);
    lit_ = Rgb{1.0f + 0.18f * warm, 1.0f, 1.0f - 0.22f * warm} * bright;
    shade_ = Rgb{0.17f - 0.05f * warm, 0.18f, 0.22f + 0.07f * warm} * random.between(0.5f, 1.2f);
    backdrop_ = Rgb{0.012f, 0.015f, 0.021f} * random.between(0.1f, 1.6f);
  }

  FilmOptions film() const override { return {.exposure = 0.9f, .bloom = 0.06f}; }
  int warm_up_frames() const override { return static_cast<int>(125.0f / rate_); }

  void advance() override {
    ++clock_;
    const float time = static_cast<float>(clock_) * rate_;
    Grid& density = gas_.fields[0];
    feed(density, time);
    gas_.reduce(density, cells_);
    const float breeze = wind_ * (1.0f + gust_ * noise_(0.013f * time, 5.5f) * 2.0f);
    for_rows(gas_.force.height, [&](int y) {
      const float height_fraction = 1.0f - static_cast<float>(y) / static_cast<float>(gas_.force.height);
      for (int x = 0; x < gas_.force.width; ++x) {
        const Vec2 v = gas_.flow.velocity()(x, y);
        // Drag towards a wind that grows with height; still air beside the plume damps stray eddies.
        const float drag = 0.02f * rate_;
        gas_.force(x, y) = {drag * (breeze * (0.3f + 1.4f * height_fraction) - v.x),
                            -buoyancy_ * std::min(cells_(x, y) * 1.5f, 1.0f) - 0.008f * rate_ * v.y};
      }
    });
    gas_.stir(noise_, 0.07f * time, 20.0f, 0.10f * rate_ * speed_unit(), cells_);
    gas_.hold_back(terminal_, buoyancy_);
    gas_.advance(Gas::Edges::kSoft);
    const float kept = 1.0f - 0.009f * rate_;
    for_rows(density.height, [&](int y) {
      float* p = gas_.fields[0].row(y);
      for (int x = 0; x < density.width; ++x) p[x] *= kept;
    });
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    gather();
    shine();
    const int w = thick_.width, h = thick_.height;
    for_rows(h, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const int above = std::max(y - 3, 0), below = std::min(y + 3, h - 1);
      const float backdrop_y = static_cast<float>(y) / static_cast<float>(h);
      for (int x = 0; x < w; ++x) {
        const int left = std::max(x - 3, 0), right = std::min(x + 3, w - 1);
        const float t = thick_(x, y);
        const float cover = 1.0f - exp_portable(-opacity_ * t);
        const float slope =
            (light_ * (thick_(left, y) - thick_(right, y)) + (thick_(x, above) - thick_(x, below)));
        const float facing = std::clamp(0.55f - 0.38f * slope, 0.0f, 1.0f);
        const float reached = exp_portable(-1.9f * toward_light_(x, y));
        const Rgb smoke = mix(shade_, lit_, reached * (0.35f + 0.65f * facing));
        const Rgb back =
            backdrop_ * (1.6f - backdrop_y +
                         0.15f * noise_.fractal(static_cast<float>(x) / (70.0f * gas_.domain.scale),
                                                static_cast<float>(y) / (90.0f * gas_.domain.scale), 2));
        out[x] = mix(back, smoke, cover);
        a[x] = static_cast<std::uint8_t>(cover * 255.0f + 0.5f);
        m[x] = a[x] > 0 ? gas_.motion_at(x, y) : Vec2{};
      }
    });
  }

 private:
  static StableFluidsOptions flow_options() { return {.confinement = 0.03f, .max_speed = 16.0f}; }
  /// Cells per frame for one design px (a 640 x 360 picture's) per frame.
  float speed_unit() const { return gas_.domain.scale / static_cast<float>(gas_.domain.step); }

  void feed(Grid& density, float time) const {
    for (const Vent& vent : vents_) {
      const float beat = 0.75f + 0.5f * noise_(time * vent.pulse, vent.phase);
      const float reach = vent.radius * (0.85f + 0.3f * beat);
      const int y0 = std::max(0, static_cast<int>(vent.y - reach)),
                y1 = std::min(density.height - 1, static_cast<int>(vent.y + reach));
      const int x0 = std::max(0, static_cast<int>(vent.x - 2.0f * reach)),
                x1 = std::min(density.width - 1, static_cast<int>(vent.x + 2.0f * reach));
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          const float dx = (static_cast<float>(x) - vent.x) / (2.0f * reach),
                      dy = (static_cast<float>(y) - vent.y) / reach;
          const float lumps = noise_.changing(
              static_cast<float>(x) / (0.45f * vent.radius),
              static_cast<float>(y) / (0.45f * vent.radius) + 0.12f * time + vent.phase, 0.2f * time, 2);
          const float fill = vent.strength * beat * smoothstep(1.0f, 0.3f, dx * dx + dy * dy) *
                             std::clamp(0.7f + 1.3f * lumps, 0.0f, 1.5f);
          density(x, y) = std::max(density(x, y), std::min(fill, 1.3f));
        }
      }
    }
  }

  /// Density with the carried texture's finer lumps, at the picture's size.
  void gather() {
    const Domain& d = gas_.domain;
    const float step = static_cast<float>(d.step), pitch = detail_ / d.scale;
    for_rows(thick_.height, [&](int y) {
      const float fy = static_cast<float>(y + d.top), cy = d.cell_from_fine(fy);
      const float* density = gas_.fields[0].row(y + d.top) + d.left;
      float* out = thick_.row(y);
      for (int x = 0; x < thick_.width; ++x) {
        if (density[x] < 1e-3f) {
          out[x] = 0.0f;
          continue;
        }
        const float fx = static_cast<float>(x + d.left), cx = d.cell_from_fine(fx);
        const float lumps = gas_.texture.blended(cx, cy, [&](Vec2 o, Vec2 shift) {
          return noise_.fractal((fx + step * o.x) * pitch + shift.x, (fy + step * o.y) * pitch + shift.y, 4,
                                0.66f);
        });
        out[x] = density[x] * std::clamp(0.85f + 0.75f * lumps, 0.1f, 2.0f);
      }
    });
  }

  /// Smoke between a pixel and the light above: a mean along the ray that forgets with distance. Row follows
  /// row.
  void shine() {
    const float forget = 0.05f / gas_.domain.scale;
    const float weight = std::min(forget, 0.5f);
    for (int y = 0; y < thick_.height; ++y) {
      const float* t = thick_.row(y);
      float* out = toward_light_.row(y);
      if (y == 0) {
        for (int x = 0; x < thick_.width; ++x) out[x] = t[x];
        continue;
      }
      const float* above = toward_light_.row(y - 1);
      for (int x = 0; x < thick_.width; ++x) {
        const Tap tx = tap(static_cast<float>(x) + light_, thick_.width);
        const float before = above[tx.index] + (above[tx.index + tx.step] - above[tx.index]) * tx.weight;
        out[x] = before + weight * (t[x] - before);
      }
    }
  }

  Noise noise_;
  float rate_;  // frames of a 25 a second design in one of ours
  Gas gas_;
  Grid cells_, thick_, toward_light_;
  std::vector<Vent> vents_;
  float buoyancy_, terminal_, wind_, gust_, light_, opacity_, detail_;
  Rgb lit_, shade_, backdrop_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_smoke(const SceneOptions& options) { return std::make_unique<Smoke>(options); }

}  // namespace freshet::synth::simulate
