// synth/simulate/clips/ink.cc — two inks that sink through bright water.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/clips/gas.h"
#include "synth/simulate/scene/simulated_scene.h"

namespace freshet::synth::simulate {
namespace {

struct Nozzle {
  float x, y, radius, phase;  // px of the domain
  std::size_t dye;
};

class Ink final : public Scene {
 public:
  explicit Ink(const SceneOptions& options)
      : noise_(options.seed),
        rate_(25.0f / static_cast<float>(options.fps)),
        gas_(Domain(options, 0.08f, 0.08f, 0.10f), options.variation.zoom, flow_options(), 2,
             std::max(8, static_cast<int>(16.0f / rate_))),
        cells_{Grid(gas_.domain.width, gas_.domain.height), Grid(gas_.domain.width, gas_.domain.height)},
        thick_{Grid(options.size.width, options.size.height), Grid(options.size.width, options.size.height)} {
    Random random(options.seed, 105);
    const Domain& d = gas_.domain;
    const int nozzles = 2 + random.below(3);
    for (int i = 0; i < nozzles; ++i) {
      const float fraction =
          (static_cast<float>(i) + random.between(0.25f, 0.75f)) / static_cast<float>(nozzles);
      nozzles_.push_back({.x = static_cast<float>(d.left) +
                               (0.06f + 0.88f * fraction) * static_cast<float>(options.size.width),
                          .y = static_cast<float>(d.top) +
                               random.between(-0.05f, 0.03f) * static_cast<float>(options.size.height),
                          .radius = d.scale * random.between(11.0f, 24.0f),
                          .phase = random.between(0.0f, 60.0f),
                          .dye = static_cast<std::size_t>(i % 2)});
    }
    weight_[0] = random.between(0.3f, 0.42f) * rate_ * rate_ * speed_unit();
    weight_[1] = random.between(0.24f, 0.36f) * rate_ * rate_ * speed_unit();
    terminal_ = random.between(4.2f, 6.0f) * rate_ * speed_unit();
    drift_ = random.between(-0.8f, 0.8f) * rate_ * speed_unit();
    // What an ink absorbs: a hue for each, at least a third of the circle apart.
    const float hue = random.next();
    absorb_[0] = absorption(hue) * (options.variation.amount * random.between(3.4f, 5.0f));
    absorb_[1] = absorption(hue + random.between(0.33f, 0.5f)) *
                 (options.variation.amount * random.between(3.2f, 4.6f));
    water_ = Rgb{0.80f, 0.85f, 0.90f} * random.between(0.8f, 1.1f);
    light_ = random.sign() * random.between(0.3f, 0.9f);
  }

  FilmOptions film() const override { return {.exposure = 0.95f, .bloom = 0.03f}; }
  int warm_up_frames() const override { return static_cast<int>(115.0f / rate_); }

  void advance() override {
    ++clock_;
    const float time = static_cast<float>(clock_) * rate_;
    for (const Nozzle& nozzle : nozzles_) feed(nozzle, time);
    for (std::size_t i = 0; i < 2; ++i) gas_.reduce(gas_.fields[i], cells_[i]);
    const float sway = drift_ * (0.5f + 2.0f * noise_(0.012f * time, 3.5f));
    for_rows(gas_.force.height, [&](int y) {
      for (int x = 0; x < gas_.force.width; ++x) {
        const Vec2 v = gas_.flow.velocity()(x, y);
        gas_.force(x, y) = {0.015f * rate_ * (sway - v.x),
                            std::min(weight_[0], 1.6f * weight_[0] * cells_[0](x, y)) +
                                std::min(weight_[1], 1.6f * weight_[1] * cells_[1](x, y)) -
                                0.02f * rate_ * v.y};
        cells_[0](x, y) = std::min(1.0f, cells_[0](x, y) + cells_[1](x, y));
      }
    });
    gas_.stir(noise_, 0.045f * time, 19.0f, 0.08f * rate_ * speed_unit(), cells_[0]);
    gas_.hold_back(terminal_, weight_[0]);
    gas_.advance(Gas::Edges::kSharp);
    const float kept = 1.0f - 0.004f * rate_;
    for (Grid& field : gas_.fields) {
      for_rows(field.height, [&](int y) {
        float* p = field.row(y);
        for (int x = 0; x < field.width; ++x) p[x] *= kept;
      });
    }
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    gather();
    const int w = film.light.width, h = film.light.height;
    for_rows(h, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const int above = std::max(y - 2, 0), below = std::min(y + 2, h - 1);
      const float fy = static_cast<float>(y) / static_cast<float>(h) - 0.4f;
      for (int x = 0; x < w; ++x) {
        const float fx = static_cast<float>(x) / static_cast<float>(w) - 0.5f;
        const Rgb back = water_ * (1.12f - 0.9f * (fx * fx + fy * fy));
        const float t0 = thick_[0](x, y), t1 = thick_[1](x, y), t = t0 + t1;
        if (t <= 0.0f) {
          out[x] = back, a[x] = 0, m[x] = {};
          continue;
        }
        const int left = std::max(x - 2, 0), right = std::min(x + 2, w - 1);
        const auto both = [&](int i, int j) { return thick_[0](i, j) + thick_[1](i, j); };
        const float slope = light_ * (both(left, y) - both(right, y)) + both(x, above) - both(x, below);
        const Rgb through{exp_portable(-t0 * absorb_[0].r - t1 * absorb_[1].r),
                          exp_portable(-t0 * absorb_[0].g - t1 * absorb_[1].g),
                          exp_portable(-t0 * absorb_[0].b - t1 * absorb_[1].b)};
        const float cover = 1.0f - exp_portable(-2.6f * t);
        // Dense ink scatters a little of its own colour back, brighter on the side of the light.
        const float scattered = 0.22f * cover * cover * std::clamp(0.55f - 0.5f * slope, 0.0f, 1.6f);
        const Rgb own = mix(through * 0.6f, Rgb{0.5f, 0.5f, 0.5f}, 0.12f) * scattered;
        out[x] = back * through * (1.0f - 0.1f * std::clamp(slope, -1.0f, 1.0f) * cover) + own;
        a[x] = static_cast<std::uint8_t>(255.0f * cover + 0.5f);
        m[x] = a[x] > 0 ? gas_.motion_at(x, y) : Vec2{};
      }
    });
  }

 private:
  static StableFluidsOptions flow_options() {
    return {.bottom = Edge::kFixed, .confinement = 0.04f, .max_speed = 16.0f};
  }
  float speed_unit() const { return gas_.domain.scale / static_cast<float>(gas_.domain.step); }

  static Rgb absorption(float hue) {
    const auto part = [&](float shift) { return 0.56f - 0.44f * cos_turns(hue + shift); };
    return {part(0.0f), part(0.333f), part(0.667f)};
  }

  void feed(const Nozzle& n, float time) {
    Grid& dye = gas_.fields[n.dye];
    const float beat = std::clamp(0.75f + 1.1f * noise_(0.05f * time, n.phase), 0.0f, 1.2f);
    const float cx = n.x + 0.9f * n.radius * noise_(0.04f * time, n.phase + 9.0f),
                r = n.radius * (0.7f + 0.4f * beat);
    const int y0 = std::max(0, static_cast<int>(n.y - r)),
              y1 = std::min(dye.height - 1, static_cast<int>(n.y + r));
    const int x0 = std::max(0, static_cast<int>(cx - r)),
              x1 = std::min(dye.width - 1, static_cast<int>(cx + r));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const float dx = (static_cast<float>(x) - cx) / r, dy = (static_cast<float>(y) - n.y) / r;
        const float lumps =
            noise_.changing(static_cast<float>(x) / (0.5f * n.radius),
                            static_cast<float>(y) / (0.5f * n.radius) - 0.1f * time, 0.1f * time, 2);
        const float fill =
            beat * smoothstep(1.0f, 0.5f, dx * dx + dy * dy) * std::clamp(0.8f + lumps, 0.0f, 1.3f);
        dye(x, y) = std::max(dye(x, y), fill);
      }
    }
  }

  void gather() {
    const Domain& d = gas_.domain;
    const float step = static_cast<float>(d.step), pitch = 0.06f / d.scale;
    for_rows(thick_[0].height, [&](int y) {
      const float fy = static_cast<float>(y + d.top), cy = d.cell_from_fine(fy);
      const float* dye0 = gas_.fields[0].row(y + d.top) + d.left;
      const float* dye1 = gas_.fields[1].row(y + d.top) + d.left;
      for (int x = 0; x < thick_[0].width; ++x) {
        if (dye0[x] + dye1[x] < 1e-3f) {
          thick_[0](x, y) = thick_[1](x, y) = 0.0f;
          continue;
        }
        const float fx = static_cast<float>(x + d.left), cx = d.cell_from_fine(fx);
        const float lumps = gas_.texture.blended(cx, cy, [&](Vec2 o, Vec2 shift) {
          return noise_.fractal((fx + step * o.x) * pitch + shift.x, (fy + step * o.y) * pitch + shift.y, 3,
                                0.55f);
        });
        const float gain = std::clamp(0.9f + 0.5f * lumps, 0.25f, 1.8f);
        thick_[0](x, y) = dye0[x] * gain;
        thick_[1](x, y) = dye1[x] * gain;
      }
    });
  }

  Noise noise_;
  float rate_;
  Gas gas_;
  Grid cells_[2], thick_[2];
  std::vector<Nozzle> nozzles_;
  float weight_[2], terminal_, drift_, light_;
  Rgb absorb_[2], water_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_ink(const SceneOptions& options) { return std::make_unique<Ink>(options); }

}  // namespace freshet::synth::simulate
