// synth/simulate/clips/waterfall.cc — water that falls in strands over dark rock, step by step, into mist.
//
// No solver: falling water is ballistic. A point of the fall is named by its strand s (across) and by the
// time t it has been falling since the brink, and all texture is drawn in (s, t - now): it moves exactly as
// the water falls and is stretched as falling water is.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/grid.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/noise.h"

namespace freshet::synth::simulate {
namespace {

struct Ledge {
  float y;      // fraction of the height where a new drop begins
  float start;  // speed there, design px per frame
  float lip;    // unevenness, fraction of the height
  float phase;
};

class Waterfall final : public Scene {
 public:
  explicit Waterfall(const SceneOptions& options)
      : size_(options.size),
        noise_(options.seed),
        rate_(25.0f / static_cast<float>(options.fps)),
        scale_(options.variation.zoom *
               static_cast<float>(std::min(options.size.width, options.size.height)) / 360.0f),
        rock_(size_.width, size_.height),
        fall_time_(size_.width, size_.height),
        strand_(fall_time_),
        cover_(fall_time_),
        splash_(fall_time_),
        speed_(size_.width, size_.height) {
    Random random(options.seed, 104);
    const int ledges = 1 + random.below(3);
    float y = random.between(-0.25f, 0.12f);
    for (int i = 0; i < ledges; ++i) {
      ledges_.push_back({.y = y,
                         .start = random.between(2.2f, 3.6f),
                         .lip = random.between(0.015f, 0.05f),
                         .phase = random.between(0.0f, 30.0f)});
      y = std::max(y, 0.0f) + random.between(0.25f, 0.42f);
    }
    pool_ = random.between(0.84f, 1.05f);
    gravity_ = random.between(0.05f, 0.1f);
    middle_ = random.between(0.3f, 0.7f);
    half_width_ = random.between(0.16f, 0.5f);
    spread_ = random.between(0.0f, 0.35f);
    lean_ = random.between(-0.12f, 0.12f);
    fullness_ = random.between(-0.05f, 0.35f) + 0.4f * (options.variation.amount - 1.0f);
    strand_px_ = random.between(9.0f, 16.0f);
    const float warm = random.between(-1.0f, 1.0f), bright = random.between(0.75f, 1.1f);
    white_ = Rgb{0.93f + 0.07f * warm, 0.97f, 1.02f - 0.1f * warm} * (1.15f * bright);
    shade_ = Rgb{0.16f + 0.03f * warm, 0.25f, 0.34f - 0.06f * warm} * bright;
    stone_ = mix(Rgb{0.10f, 0.095f, 0.085f}, Rgb{0.06f, 0.085f, 0.045f}, random.next()) *
             random.between(0.5f, 1.3f);
    lay_out();
    paint_rock();
  }

  FilmOptions film() const override { return {.exposure = 0.85f, .bloom = 0.05f}; }
  int warm_up_frames() const override { return 0; }
  void advance() override { ++clock_; }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    const float now = static_cast<float>(clock_) * rate_;
    for_rows(size_.height, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      for (int x = 0; x < size_.width; ++x) {
        const float bed = cover_(x, y), mist = splash_(x, y);
        out[x] = rock_(x, y), a[x] = 0, m[x] = {};
        if (bed <= 0.0f && mist <= 0.0f) continue;
        const float s = strand_(x, y), t = fall_time_(x, y) - now;
        // Two sheets: the back one slower, seen through the gaps of the front one.
        const Water front = water(s, t, 0.0f),
                    back = water(s * 1.13f + 40.0f, fall_time_(x, y) * 1.12f - now, 11.0f);
        float cover =
            smoothstep(0.02f, 0.5f, bed + fullness_ + 0.95f * front.body) * smoothstep(0.0f, 0.12f, bed);
        const float behind = 0.75f * smoothstep(0.05f, 0.65f, bed + fullness_ + 0.8f * back.body) *
                             smoothstep(0.0f, 0.12f, bed);
        const Rgb far_water =
            mix(shade_ * 0.6f, shade_ * 1.5f, std::clamp(0.5f + 0.9f * back.light, 0.0f, 1.0f));
        const Rgb near_water =
            mix(shade_, white_, std::clamp(0.42f + 0.85f * front.light + 0.25f * front.body, 0.0f, 1.15f));
        Rgb c = mix(mix(out[x], far_water, behind), near_water, cover);
        cover = 1.0f - (1.0f - cover) * (1.0f - behind);
        if (mist > 0.0f) {
          const float px = static_cast<float>(x) / scale_, py = static_cast<float>(y) / scale_;
          const float puffs = noise_.changing(px / 60.0f, py / 46.0f + 0.010f * now, 0.035f * now, 4, 0.55f);
          const float veil = std::clamp(mist * (0.62f + 0.9f * puffs), 0.0f, 0.93f);
          c = mix(c, white_ * (0.72f + 0.25f * puffs), veil);
          cover = 1.0f - (1.0f - cover) * (1.0f - veil);
        }
        out[x] = c;
        a[x] = static_cast<std::uint8_t>(255.0f * cover + 0.5f);
        if (a[x] > 0) m[x] = speed_(x, y);
      }
    });
  }

 private:
  struct Water {
    float body, light;
  };
  /// s in strands, t in frames of falling.
  Water water(float s, float t, float shift) const {
    const float gush = noise_(0.23f * s + shift, 0.035f * t);
    const float strands = noise_(0.9f * s + 0.5f * gush + shift, 0.05f * t + 3.0f);
    const float ropes = noise_(2.1f * s + 0.6f * strands, 0.11f * t + shift);
    const float drops = noise_(4.3f * s + 0.8f * ropes + 5.0f, 0.27f * t + shift);
    const float spray = noise_(7.7f * s + 9.0f, 0.6f * t + shift);
    return {0.6f * gush + 0.75f * strands + 0.55f * ropes + 0.3f * drops,
            0.35f * strands + 0.6f * ropes + 0.65f * drops + 0.5f * spray};
  }

  /// What does not change: where the water runs, how long it has been falling, how fast it is.
  void lay_out() {
    const float h = static_cast<float>(size_.height), w = static_cast<float>(size_.width);
    for_rows(size_.height, [&](int y) {
      const float fraction_y = (static_cast<float>(y) + 0.5f) / h;
      for (int x = 0; x < size_.width; ++x) {
        const float fraction_x = (static_cast<float>(x) + 0.5f) / w;
        const float drop = std::max(0.0f, fraction_y - ledges_.front().y);
        const float widen = 1.0f + spread_ * drop;
        // 0 in the middle, as at the brink.
        const float across = (fraction_x - middle_ - lean_ * drop) / widen;
        const float strand = across * w / (strand_px_ * scale_);
        // Time adds up from ledge to ledge; each lip is uneven from strand to strand.
        float time = 0.0f;
        const Ledge* above = nullptr;
        float above_lip = 0.0f;
        for (const Ledge& ledge : ledges_) {
          const float lip = ledge.y + ledge.lip * noise_.fractal(strand * 0.11f + ledge.phase, 2.5f, 3);
          if (fraction_y < lip) break;
          if (above != nullptr) time += fall(std::max(0.0f, lip - above_lip) * h / scale_, above->start).time;
          above = &ledge, above_lip = lip;
        }
        if (above == nullptr) continue;
        const Drop here = fall((fraction_y - above_lip) * h / scale_, above->start);
        fall_time_(x, y) = time + here.time;
        strand_(x, y) = strand;
        const float v = here.speed * rate_ * scale_;
        speed_(x, y) = {v * (across * spread_ + lean_) * w / h, v};
        const float ragged =
            0.05f * noise_.fractal(fraction_y * 5.0f + ledges_.front().phase, across < 0 ? 1.5f : 9.5f, 3);
        const float inside = half_width_ + ragged - std::fabs(across);
        const float ridges = 0.45f * noise_.fractal(strand * 0.16f, fraction_y * 3.0f, 3);
        cover_(x, y) = smoothstep(-0.01f, 0.06f, inside) * std::clamp(0.42f + ridges, 0.02f, 1.0f);
        if (inside < -0.06f) cover_(x, y) = 0.0f;
      }
    });
    for_rows(size_.height, [&](int y) {
      const float fraction_y = (static_cast<float>(y) + 0.5f) / h;
      for (int x = 0; x < size_.width; ++x) {
        const float fraction_x = (static_cast<float>(x) + 0.5f) / w;
        const float drop = std::max(0.0f, fraction_y - ledges_.front().y);
        const float across = std::fabs((fraction_x - middle_ - lean_ * drop) / (1.0f + spread_ * drop));
        float mist = 0.0f;
        for (std::size_t i = 1; i < ledges_.size(); ++i) {
          const float dy = (fraction_y - ledges_[i].y) / 0.05f;
          mist = std::max(mist, 0.45f * exp_portable(-dy * dy));
        }
        mist = std::max(mist, 0.95f * smoothstep(pool_ - 0.22f, pool_ + 0.06f, fraction_y));
        splash_(x, y) = mist * smoothstep(half_width_ + 0.2f, half_width_ - 0.02f, across);
        if (splash_(x, y) > 0.0f && speed_(x, y).y <= 0.0f) speed_(x, y) = {0.0f, -0.4f * rate_ * scale_};
      }
    });
  }

  struct Drop {
    float time, speed;  // frames, design px per frame
  };
  Drop fall(float distance, float start) const {
    const float speed = std::sqrt(start * start + 2.0f * gravity_ * distance);
    return {(speed - start) / gravity_, speed};
  }
  void paint_rock() {
    Grid height(size_.width, size_.height);
    for_rows(size_.height, [&](int y) {
      for (int x = 0; x < size_.width; ++x) {
        const float px = static_cast<float>(x) / scale_, py = static_cast<float>(y) / scale_;
        const float bent = noise_.fractal(px / 150.0f, py / 150.0f, 3);
        const float slabs =
            1.0f - 2.0f * std::fabs(noise_.fractal(px / 70.0f + bent, py / 42.0f + 0.6f * bent, 5, 0.55f));
        height(x, y) = slabs + 0.5f * bent;
      }
    });
    for_rows(size_.height, [&](int y) {
      const int above = std::max(y - 1, 0), below = std::min(y + 1, size_.height - 1);
      for (int x = 0; x < size_.width; ++x) {
        const int left = std::max(x - 1, 0), right = std::min(x + 1, size_.width - 1);
        const float slope =
            (height(x, below) - height(x, above)) * 2.2f + (height(right, y) - height(left, y)) * 1.3f;
        const float light = std::clamp(0.75f + slope * scale_ * 1.4f, 0.08f, 2.4f) *
                            std::clamp(0.75f + 0.35f * height(x, y), 0.15f, 1.3f);
        const float moss = smoothstep(0.1f, 0.7f,
                                      noise_.fractal(static_cast<float>(x) / (90.0f * scale_),
                                                     static_cast<float>(y) / (90.0f * scale_) + 11.0f, 4));
        const Rgb base = mix(stone_, Rgb{0.05f, 0.085f, 0.03f}, 0.6f * moss);
        const float wet = 1.0f - 0.5f * std::min(1.0f, 2.0f * cover_(x, y));
        rock_(x, y) = base * (light * wet);
      }
    });
  }

  cv::Size size_;
  Noise noise_;
  float rate_, scale_;
  GridOf<Rgb> rock_;
  Grid fall_time_, strand_, cover_, splash_;  // frames; strands; 0..1; 0..1
  VectorGrid speed_;                          // px per frame
  std::vector<Ledge> ledges_;
  float pool_, gravity_, middle_, half_width_, spread_, lean_, fullness_, strand_px_;
  Rgb white_, shade_, stone_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_waterfall(const SceneOptions& options) {
  return std::make_unique<Waterfall>(options);
}

}  // namespace freshet::synth::simulate
