// synth/simulate/clips/fire.cc — flames over a bed of fuel at night, with sparks.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/clips/gas.h"
#include "synth/simulate/scene/simulated_scene.h"

namespace freshet::synth::simulate {
namespace {

struct Bed {
  float x, y, half_width;  // px of the domain
  float strength, phase;
};
struct Spark {
  float x = 0, y = 0;  // px of the domain
  float heat = 0;      // 0: not lit
};

class Fire final : public Scene {
 public:
  explicit Fire(const SceneOptions& options)
      : noise_(options.seed),
        rate_(25.0f / static_cast<float>(options.fps)),
        gas_(Domain(options, 0.08f, 0.06f, 0.10f), options.variation.zoom, flow_options(), 1,
             std::max(6, static_cast<int>(9.0f / rate_))),
        cells_(gas_.domain.width, gas_.domain.height),
        sparks_(90),
        seed_(options.seed) {
    Random random(options.seed, 102);
    const Domain& d = gas_.domain;
    const float w = static_cast<float>(options.size.width), h = static_cast<float>(options.size.height);
    const int beds = 1 + random.below(3);
    for (int i = 0; i < beds; ++i) {
      const float fraction = (static_cast<float>(i) + random.between(0.3f, 0.7f)) / static_cast<float>(beds);
      beds_.push_back(
          {.x = static_cast<float>(d.left) + (0.08f + 0.84f * fraction) * w,
           .y = static_cast<float>(d.top) + random.between(0.93f, 1.0f) * h,
           .half_width = random.between(0.13f, 0.26f) * w / (0.6f + 0.4f * static_cast<float>(beds)) *
                         (options.variation.zoom * options.variation.amount),
           .strength = random.between(0.85f, 1.15f),
           .phase = random.between(0.0f, 60.0f)});
    }
    buoyancy_ = random.between(0.42f, 0.62f) * rate_ * rate_ * speed_unit();
    cooling_ = random.between(0.007f, 0.013f) * rate_;
    wind_ = random.between(-1.6f, 1.6f) * rate_ * speed_unit();
    detail_ = random.between(0.045f, 0.065f);
    spark_rate_ = 0.03f * rate_ * std::min(1.0f, options.variation.amount);
    // Wood burns orange; gas and salts shift it a little either way.
    const float hue = random.between(-1.0f, 1.0f);
    tint_ = {1.0f, 1.0f + 0.14f * hue, 1.0f - 0.5f * hue};
    backdrop_ = Rgb{0.010f, 0.011f, 0.015f} * random.between(0.3f, 2.0f);
  }

  FilmOptions film() const override { return {.exposure = 1.0f, .bloom = 0.13f}; }
  int warm_up_frames() const override { return static_cast<int>(60.0f / rate_); }

  void advance() override {
    ++clock_;
    const float time = static_cast<float>(clock_) * rate_;
    Grid& heat = gas_.fields[0];
    feed(heat, time);
    gas_.reduce(heat, cells_);
    const float breeze = wind_ * (0.6f + 1.6f * noise_(0.02f * time, 9.5f));
    for_rows(gas_.force.height, [&](int y) {
      for (int x = 0; x < gas_.force.width; ++x) {
        const Vec2 v = gas_.flow.velocity()(x, y);
        gas_.force(x, y) = {0.03f * rate_ * (breeze - v.x), -buoyancy_ * cells_(x, y) - 0.035f * rate_ * v.y};
      }
    });
    gas_.stir(noise_, 0.16f * time, 22.0f, 0.30f * rate_ * speed_unit(), cells_);
    gas_.advance(Gas::Edges::kSoft);
    // Heat is lost at a steady rate and, like radiation, faster where it is hottest.
    for_rows(heat.height, [&](int y) {
      float* p = gas_.fields[0].row(y);
      for (int x = 0; x < heat.width; ++x)
        p[x] = std::max(0.0f, p[x] - cooling_ * (0.35f + 1.1f * p[x] * p[x]));
    });
    fly(time);
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    const Domain& d = gas_.domain;
    const float step = static_cast<float>(d.step), pitch = detail_ / d.scale;
    const int w = film.light.width, h = film.light.height;
    for_rows(h, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const float fy = static_cast<float>(y + d.top), cy = d.cell_from_fine(fy);
      const float* heat = gas_.fields[0].row(y + d.top) + d.left;
      for (int x = 0; x < w; ++x) {
        const float grain = noise_.fractal(static_cast<float>(x) / (26.0f * d.scale),
                                           static_cast<float>(y) / (11.0f * d.scale), 3);
        const Rgb back = backdrop_ * (0.7f + static_cast<float>(y) / static_cast<float>(h) + 0.5f * grain);
        if (heat[x] < 1e-3f) {
          out[x] = back, a[x] = 0, m[x] = {};
          continue;
        }
        const float fx = static_cast<float>(x + d.left), cx = d.cell_from_fine(fx);
        const float licks = gas_.texture.blended(cx, cy, [&](Vec2 o, Vec2 shift) {
          return noise_.fractal((fx + step * o.x) * pitch + shift.x,
                                0.55f * (fy + step * o.y) * pitch + shift.y, 3, 0.55f);
        });
        const float t = std::clamp(heat[x] * (0.88f + 0.6f * licks), 0.0f, 1.3f);
        const Rgb glow = glow_of(t);
        const float cover = 1.0f - exp_portable(-5.0f * t * t);
        out[x] = back * (1.0f - 0.8f * cover) + glow;
        a[x] = static_cast<std::uint8_t>(255.0f * cover + 0.5f);
        m[x] = a[x] > 0 ? gas_.motion_at(x, y) : Vec2{};
      }
    });
    draw_sparks(film, alpha, motion);
  }

 private:
  static StableFluidsOptions flow_options() { return {.confinement = 0.04f, .max_speed = 16.0f}; }
  float speed_unit() const { return gas_.domain.scale / static_cast<float>(gas_.domain.step); }

  /// Light of soot at heat t: red first, then yellow, white at the core. The powers stand in for Planck's
  /// law.
  Rgb glow_of(float t) const {
    const float t2 = t * t, t4 = t2 * t2;
    return Rgb{3.4f * t2, 2.3f * t2 * t * (0.35f + 0.65f * t), 1.5f * t4 * t2} * tint_ * (0.35f + 1.2f * t);
  }

  void feed(Grid& heat, float time) const {
    for (const Bed& bed : beds_) {
      const float tall = 15.0f * gas_.domain.scale;
      const int y0 = std::max(0, static_cast<int>(bed.y - tall)),
                y1 = std::min(heat.height - 1, static_cast<int>(bed.y + tall));
      const int x0 = std::max(0, static_cast<int>(bed.x - bed.half_width)),
                x1 = std::min(heat.width - 1, static_cast<int>(bed.x + bed.half_width));
      const float pitch = 1.0f / (26.0f * gas_.domain.scale);
      for (int y = y0; y <= y1; ++y) {
        const float dy = (static_cast<float>(y) - bed.y) / tall;
        for (int x = x0; x <= x1; ++x) {
          const float dx = (static_cast<float>(x) - bed.x) / bed.half_width;
          const float tongues =
              noise_.changing(static_cast<float>(x) * pitch + bed.phase,
                              static_cast<float>(y) * pitch + 0.15f * time, 0.14f * time, 2);
          const float edge = 1.0f - dx * dx;
          const float fill = bed.strength * smoothstep(0.0f, 0.6f, edge) *
                             smoothstep(1.0f, 0.4f, std::fabs(dy)) *
                             smoothstep(-0.35f, 0.35f, tongues + 0.35f * (edge - 0.5f));
          heat(x, y) = std::max(heat(x, y), fill);
        }
      }
    }
  }

  /// Sparks drift with the flow, sway, cool and are lit again at the bed. Spark i draws from its own counter.
  void fly(float time) {
    const Domain& d = gas_.domain;
    const Random random(seed_, 103);
    for (std::size_t i = 0; i < sparks_.size(); ++i) {
      Spark& s = sparks_[i];
      const std::uint64_t draw = (static_cast<std::uint64_t>(clock_) << 20) + i * 4;
      if (s.heat <= 0.0f) {
        if (random.at(draw) > spark_rate_) continue;
        const Bed& bed = beds_[random.bits(draw + 1) % beds_.size()];
        s = {bed.x + (2.0f * random.at(draw + 2) - 1.0f) * bed.half_width * 0.8f, bed.y - 20.0f * d.scale,
             0.6f + 0.4f * random.at(draw + 3)};
      }
      const Vec2 v = bilinear(gas_.flow.velocity(), d.cell_from_fine(s.x), d.cell_from_fine(s.y));
      const float sway = noise_(0.05f * time + static_cast<float>(i) * 3.7f, 0.5f);
      const float step = static_cast<float>(d.step);
      s.x += step * v.x + 1.5f * sway * rate_ * d.scale;
      s.y += step * v.y - 0.7f * rate_ * d.scale;
      s.heat -= 0.011f * rate_;
      if (!(s.y > 0.0f) || !(s.x > 0.0f) || s.x > static_cast<float>(d.fine_width()) ||
          s.y > static_cast<float>(d.fine_height()))
        s.heat = 0.0f;
    }
  }

  void draw_sparks(Film& film, cv::Mat& alpha, cv::Mat& motion) const {
    const Domain& d = gas_.domain;
    const float radius = std::max(0.8f, 1.1f * d.scale);
    for (const Spark& s : sparks_) {
      if (s.heat <= 0.0f) continue;
      const float px = s.x - static_cast<float>(d.left), py = s.y - static_cast<float>(d.top);
      const int reach = static_cast<int>(radius * 2.0f) + 1;
      const int cx = static_cast<int>(px), cy = static_cast<int>(py);
      for (int y = std::max(0, cy - reach); y <= std::min(film.light.height - 1, cy + reach); ++y) {
        for (int x = std::max(0, cx - reach); x <= std::min(film.light.width - 1, cx + reach); ++x) {
          const float dx = static_cast<float>(x) - px, dy = static_cast<float>(y) - py;
          const float spot = exp_portable(-(dx * dx + dy * dy) / (radius * radius));
          if (spot < 0.02f) continue;
          const float t = 0.35f + 0.65f * s.heat;
          film.light(x, y) = film.light(x, y) + glow_of(t) * (1.6f * spot * std::min(1.0f, 4.0f * s.heat));
          std::uint8_t& a = alpha.at<std::uint8_t>(y, x);
          a = std::max(a, static_cast<std::uint8_t>(255.0f * spot));
          const Vec2 v = gas_.motion_at(x, y);
          motion.at<cv::Vec2f>(y, x) = {v.x, v.y};
        }
      }
    }
  }

  Noise noise_;
  float rate_;
  Gas gas_;
  Grid cells_;
  std::vector<Bed> beds_;
  std::vector<Spark> sparks_;
  std::uint64_t seed_;
  float buoyancy_, cooling_, wind_, detail_;
  float spark_rate_;  // share of those that are out which are lit in a frame
  Rgb tint_, backdrop_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_fire(const SceneOptions& options) { return std::make_unique<Fire>(options); }

}  // namespace freshet::synth::simulate
