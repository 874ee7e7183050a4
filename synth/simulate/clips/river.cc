// synth/simulate/clips/river.cc — a fast, shallow river between rocks, seen from its bank.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/clips/gas.h"
#include "synth/simulate/scene/simulated_scene.h"

namespace freshet::synth::simulate {
namespace {

/// Where the water meets land, and the stones in it. Fractions of the picture; the flow runs to the right, a
/// mirrored scene is turned round when it is drawn.
struct Stone {
  float x, y, rx, ry, phase;
};
struct Course {
  float shore, shore_phase;
  std::vector<Stone> stones;

  Course(std::uint64_t seed) {
    Random random(seed, 107);
    shore = random.between(0.06f, 0.26f);
    shore_phase = random.between(0.0f, 30.0f);
    const int count = 1 + random.below(6);
    for (int i = 0; i < count; ++i) {
      const float y = random.between(shore + 0.08f, 0.98f),
                  size = random.between(0.5f, 1.0f) * (0.35f + 0.9f * y);
      stones.push_back(
          {random.between(0.08f, 0.92f), y, 0.085f * size, 0.075f * size, random.between(0.0f, 30.0f)});
    }
  }
  /// Above 0 on land, in fractions of the height or so.
  float land(const Noise& noise, float x, float y, float aspect) const {
    float land = shore + 0.03f * noise.fractal(x * 5.0f + shore_phase, shore_phase, 3) - y;
    for (const Stone& s : stones) {
      const float dx = (x - s.x) / s.rx, dy = (y - s.y) / s.ry;
      const float ragged = 0.3f * noise.fractal(x * 14.0f * aspect + s.phase, y * 14.0f, 2);
      land = std::max(land, (1.0f + ragged - std::sqrt(dx * dx + dy * dy)) * s.ry);
    }
    return land;
  }
};

GridOf<std::uint8_t> solid_cells(const Domain& d, const Course& course, const Noise& noise) {
  GridOf<std::uint8_t> solid(d.width, d.height);
  const float w = static_cast<float>(d.picture.width), h = static_cast<float>(d.picture.height);
  for (int y = 0; y < d.height; ++y) {
    for (int x = 0; x < d.width; ++x) {
      const float px =
          (static_cast<float>(x) + 0.5f) * static_cast<float>(d.step) - static_cast<float>(d.left);
      const float py =
          (static_cast<float>(y) + 0.5f) * static_cast<float>(d.step) - static_cast<float>(d.top);
      solid(x, y) = course.land(noise, px / w, py / h, w / h) > 0.0f;
    }
  }
  return solid;
}

class River final : public Scene {
 public:
  explicit River(const SceneOptions& options)
      : noise_(options.seed),
        rate_(25.0f / static_cast<float>(options.fps)),
        course_(options.seed),
        domain_(options, 0.08f, 0.0f, 0.05f),
        solid_(solid_cells(domain_, course_, noise_)),
        gas_(domain_, options.variation.zoom,
             {.left = Edge::kFixed,
              .top = Edge::kFixed,
              .bottom = Edge::kFixed,
              .confinement = 0.02f,
              .max_speed = 16.0f},
             1, std::max(6, static_cast<int>(12.0f / rate_)), solid_),
        rough_(domain_.width, domain_.height),
        wave_(options.size.width, options.size.height),
        foam_(wave_),
        land_(wave_),
        ground_(options.size.width, options.size.height) {
    Random random(options.seed, 108);
    mirrored_ = random.sign() > 0.0f;
    horizon_ = -random.between(0.25f, 0.7f);
    speed_ = random.between(4.2f, 7.0f) * rate_ * domain_.scale / static_cast<float>(domain_.step);
    white_ = random.between(0.55f, 1.5f) * options.variation.amount;
    chop_ = random.between(0.8f, 1.3f);
    const float kind = random.next();  // glacial, peaty or grey-green
    deep_ = kind < 0.4f   ? mix(Rgb{0.004f, 0.10f, 0.12f}, Rgb{0.02f, 0.20f, 0.19f}, random.next())
            : kind < 0.7f ? mix(Rgb{0.035f, 0.03f, 0.018f}, Rgb{0.07f, 0.065f, 0.035f}, random.next())
                          : mix(Rgb{0.015f, 0.035f, 0.05f}, Rgb{0.03f, 0.06f, 0.055f}, random.next());
    sky_ =
        mix(Rgb{0.35f, 0.48f, 0.66f}, Rgb{0.75f, 0.68f, 0.58f}, random.next()) * random.between(0.7f, 1.1f);
    stone_ =
        mix(Rgb{0.11f, 0.10f, 0.09f}, Rgb{0.07f, 0.09f, 0.05f}, random.next()) * random.between(0.7f, 1.4f);
    std::vector<float> inflow(static_cast<std::size_t>(domain_.height));
    for (int y = 0; y < domain_.height; ++y) {
      inflow[static_cast<std::size_t>(y)] = solid_(0, y) ? 0.0f : pace(y);
    }
    gas_.flow.set_inflow_left(inflow);
    paint_ground();
  }

  FilmOptions film() const override { return {.exposure = 0.95f, .bloom = 0.05f}; }
  int warm_up_frames() const override { return static_cast<int>(60.0f / rate_); }

  void advance() override {
    ++clock_;
    const float time = static_cast<float>(clock_) * rate_;
    for_rows(domain_.height, [&](int y) {
      const float want = pace(y);
      for (int x = 0; x < domain_.width; ++x) {
        const Vec2 v = gas_.flow.velocity()(x, y);
        const float pull = 0.05f * rate_;
        gas_.force(x, y) = {pull * (want - v.x), -pull * 0.6f * v.y};
        rough_(x, y) = solid_(x, y) ? 0.0f : pace(y) / speed_;
      }
    });
    gas_.stir(noise_, 0.05f * time, 22.0f, 0.022f * speed_, rough_);
    gas_.advance(Gas::Edges::kSharp);
    froth(time);
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    ripple();
    const int w = wave_.width, h = wave_.height;
    for_rows(h, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const int above = std::max(y - 1, 0), below = std::min(y + 1, h - 1);
      const float near = static_cast<float>(y) / static_cast<float>(h);
      for (int x = 0; x < w; ++x) {
        const int left = std::max(x - 1, 0), right = std::min(x + 1, w - 1);
        const float wet = smoothstep(0.004f, -0.006f, land_(x, y));
        const float sx = (wave_(right, y) - wave_(left, y)) * domain_.scale,
                    sy = (wave_(x, below) - wave_(x, above)) * domain_.scale;
        // A face turned to the far side mirrors the bright low sky, one turned to us shows the water's own
        // colour.
        const float mirror = std::clamp(0.26f - 0.12f * near - 1.5f * chop_ * sy + 0.7f * sx, 0.03f, 0.95f);
        const float glint = smoothstep(0.22f, 0.42f, -sy * chop_ + 0.5f * sx);
        const float crest = wave_(x, y);
        const Rgb body = deep_ * (0.75f + 0.9f * std::clamp(crest + 0.3f, 0.0f, 1.5f));
        Rgb c = mix(body, sky_, mirror) + Rgb{1.0f, 0.98f, 0.94f} * (1.1f * glint);
        const float foam = foam_(x, y);
        const float lit = std::clamp(0.74f - 0.9f * sy + 0.5f * sx + 0.2f * crest, 0.2f, 1.25f);
        c = mix(c, Rgb{0.92f, 0.96f, 1.0f} * lit, foam);
        out[x] = mix(ground_(x, y), c, wet);
        a[x] = static_cast<std::uint8_t>(255.0f * wet + 0.5f);
        m[x] = a[x] > 0 ? gas_.motion_at(x, y) : Vec2{};
      }
      if (!mirrored_) return;
      std::reverse(out, out + w), std::reverse(a, a + w), std::reverse(m, m + w);
      for (int x = 0; x < w; ++x) m[x].x = 0.0f - m[x].x;
    });
  }

 private:
  /// Perspective: px per unit of the water's plane at a row, 1 at the bottom of the picture.
  float nearness(float py) const {
    return (py / static_cast<float>(domain_.picture.height) - horizon_) / (1.0f - horizon_);
  }
  /// Wanted speed in a row of cells, cells per frame.
  float pace(int y) const {
    return speed_ *
           std::max(0.1f, nearness((static_cast<float>(y) + 0.5f) * static_cast<float>(domain_.step) -
                                   static_cast<float>(domain_.top)));
  }

  /// Foam is made where the flow is sheared, above all in the wakes of stones, and at random crests; it
  /// fades.
  void froth(float time) {
    Grid& foam = gas_.fields[0];
    const VectorGrid& v = gas_.flow.velocity();
    for_rows(domain_.height, [&](int y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, domain_.height - 1);
      for (int x = 0; x < domain_.width; ++x) {
        const int left = std::max(x - 1, 0), right = std::min(x + 1, domain_.width - 1);
        const float curl =
            std::fabs(v(right, y).y - v(left, y).y - v(x, below).x + v(x, above).x) / (speed_ + 1e-6f);
        const float squeeze = std::fabs(v(right, y).x - v(left, y).x) / (speed_ + 1e-6f);
        rough_(x, y) = std::clamp(1.3f * curl + 1.6f * squeeze - 0.30f, 0.0f, 1.0f);
      }
    });
    const float kept = 1.0f - 0.045f * rate_, gain = 0.16f * white_ * rate_;
    for_rows(foam.height, [&](int y) {
      const float cy = domain_.cell_from_fine(static_cast<float>(y));
      const float near = std::max(0.1f, nearness(static_cast<float>(y)));
      const float pitch = 1.0f / (46.0f * domain_.scale * near);
      float* p = foam.row(y);
      for (int x = 0; x < foam.width; ++x) {
        const float stirred = bilinear(rough_, domain_.cell_from_fine(static_cast<float>(x)), cy);
        const float patch = noise_(static_cast<float>(x) * pitch - 0.09f * time,
                                   static_cast<float>(y) * pitch * 1.7f + 0.011f * time);
        const float crest = std::max(0.0f, patch - 0.45f) * 0.20f * white_ * rate_;
        p[x] = std::min(1.2f, p[x] * kept + gain * stirred + crest);
      }
    });
  }

  /// Waves and foam at the picture's size, carried by the flow and foreshortened with distance.
  void ripple() {
    const float step = static_cast<float>(domain_.step),
                middle = 0.5f * static_cast<float>(domain_.picture.width);
    const float unit = 1.0f / (52.0f * domain_.scale);
    for_rows(wave_.height, [&](int y) {
      const float fy = static_cast<float>(y + domain_.top), cy = domain_.cell_from_fine(fy);
      const float* froth = gas_.fields[0].row(y + domain_.top) + domain_.left;
      for (int x = 0; x < wave_.width; ++x) {
        const float fx = static_cast<float>(x + domain_.left), cx = domain_.cell_from_fine(fx);
        float wave = 0.0f, lace = 0.0f;
        for (int map = 0; map < CarriedTexture::kMaps; ++map) {
          const Vec2 o = bilinear(gas_.texture.offset(map), cx, cy), shift = gas_.texture.shift(map);
          const float near = std::max(0.1f, nearness(static_cast<float>(y) + step * o.y));
          const float u = (static_cast<float>(x) + step * o.x - middle) * unit / near + shift.x;
          const float v = -static_cast<float>(domain_.picture.height) * unit * 1.6f / near + shift.y;
          const float n = noise_.fractal(0.6f * u, v, 5, 0.52f);
          wave += gas_.texture.weight(map) * n;
          lace += gas_.texture.weight(map) * noise_.fractal(1.6f * u + 5.0f, 2.6f * v + 0.5f * n, 3, 0.65f);
        }
        wave_(x, y) = 0.6f * wave;
        foam_(x, y) = std::clamp(smoothstep(0.22f, 0.95f, froth[x] * 0.8f + 0.42f * lace + 0.18f * wave) *
                                     smoothstep(0.03f, 0.4f, froth[x]),
                                 0.0f, 1.0f);
      }
    });
  }

  void paint_ground() {
    const float w = static_cast<float>(wave_.width), h = static_cast<float>(wave_.height);
    Grid height(wave_.width, wave_.height);
    for_rows(wave_.height, [&](int y) {
      for (int x = 0; x < wave_.width; ++x) {
        const float px = static_cast<float>(x) / domain_.scale, py = static_cast<float>(y) / domain_.scale;
        land_(x, y) = course_.land(noise_, (static_cast<float>(x) + 0.5f) / w,
                                   (static_cast<float>(y) + 0.5f) / h, w / h);
        height(x, y) = 9.0f * std::min(0.1f, std::max(0.0f, land_(x, y))) +
                       0.5f * noise_.fractal(px / 40.0f, py / 30.0f, 5, 0.6f);
      }
    });
    for_rows(wave_.height, [&](int y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, wave_.height - 1);
      for (int x = 0; x < wave_.width; ++x) {
        const int left = std::max(x - 1, 0), right = std::min(x + 1, wave_.width - 1);
        const float slope =
            (height(x, below) - height(x, above)) * 2.0f + (height(right, y) - height(left, y)) * 1.2f;
        const float light = std::clamp(0.8f + 1.5f * slope * domain_.scale, 0.08f, 2.6f);
        const float wet = smoothstep(0.03f, 0.0f, land_(x, y));
        const float moss =
            smoothstep(0.0f, 0.5f,
                       noise_.fractal(static_cast<float>(x) / (70.0f * domain_.scale),
                                      static_cast<float>(y) / (60.0f * domain_.scale) + 11.0f, 4));
        ground_(x, y) = mix(stone_, Rgb{0.05f, 0.09f, 0.03f}, 0.55f * moss) * (light * (1.0f - 0.55f * wet));
      }
    });
  }

  Noise noise_;
  float rate_;
  Course course_;
  Domain domain_;
  GridOf<std::uint8_t> solid_;
  Gas gas_;
  Grid rough_, wave_, foam_, land_;
  GridOf<Rgb> ground_;
  bool mirrored_;
  float horizon_, speed_, white_, chop_;
  Rgb deep_, sky_, stone_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_river(const SceneOptions& options) { return std::make_unique<River>(options); }

}  // namespace freshet::synth::simulate
