// synth/simulate/clips/fountain.cc — jets of water that break into drops, against the dark.
//
// No solver: a drop is thrown and falls. Drop i of a jet is thrown again and again, each time a little otherwise, and
// its place is a function of the time alone.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/noise.h"

namespace freshet::synth::simulate {
namespace {

/// Lengths in heights of the picture, y down.
struct Jet {
  float x, y;
  Vec2 velocity;  // heights per second
  float spread;   // of the velocity, a fraction
};
struct Drop {
  Vec2 place, velocity;
  float light, radius;
};

class Fountain final : public Scene {
 public:
  explicit Fountain(const SceneOptions& options)
      : size_(options.size),
        noise_(options.seed),
        second_(1.0f / static_cast<float>(options.fps)),
        zoom_(options.variation.zoom),
        seed_(options.seed) {
    Random random(options.seed, 112);
    gravity_ = random.between(1.0f, 1.5f) * zoom_;
    const int jets = 1 + random.below(4);
    const float aspect = static_cast<float>(size_.width) / static_cast<float>(size_.height);
    for (int i = 0; i < jets; ++i) {
      const float rise = random.between(0.45f, 0.8f) * zoom_;  // how high it goes
      jets_.push_back(
          {.x = aspect * (static_cast<float>(i) + random.between(0.35f, 0.65f)) / static_cast<float>(jets),
           .y = random.between(0.95f, 1.02f),
           .velocity = {random.between(-0.12f, 0.12f) * zoom_, -std::sqrt(2.0f * gravity_ * rise)},
           .spread = random.between(0.05f, 0.11f)});
    }
    drops_ = static_cast<int>(1800.0f * options.variation.amount);
    white_ = Rgb{0.93f, 0.97f, 1.0f} * random.between(0.5f, 0.8f);
    backdrop_ =
        mix(Rgb{0.02f, 0.035f, 0.03f}, Rgb{0.03f, 0.04f, 0.07f}, random.next()) * random.between(0.4f, 1.6f);
  }

  FilmOptions film() const override { return {.exposure = 0.9f, .bloom = 0.05f}; }
  int warm_up_frames() const override { return 0; }
  void advance() override { ++clock_; }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    const int w = size_.width, h = size_.height;
    const float height = static_cast<float>(h);
    const std::vector<Drop> drops = drops_at(1.0f + second_ * static_cast<float>(clock_));
    for_rows(h, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      for (int x = 0; x < w; ++x) {
        const float grain = noise_.fractal(static_cast<float>(x) / (0.08f * height),
                                           static_cast<float>(y) / (0.05f * height), 3);
        out[x] = backdrop_ * (0.8f + 0.5f * grain), a[x] = 0, m[x] = {};
      }
      // Each row takes its drops in their order: the same sums for any number of threads.
      const float row = static_cast<float>(y);
      std::vector<float> cover(static_cast<std::size_t>(w));
      std::vector<Vec2> carried(static_cast<std::size_t>(w));
      for (const Drop& drop : drops) {
        const float radius = drop.radius * height;
        // Streaked along its way, as far as a quarter of a frame carries it.
        const float streak = 1.0f + 0.25f * std::fabs(drop.velocity.y) * second_ / drop.radius;
        const float dy = (row - drop.place.y * height) / (radius * streak);
        if (std::fabs(dy) > 2.0f) continue;
        const float cx = drop.place.x * height;
        const int from = std::max(0, static_cast<int>(std::max(0.0f, cx - 2.0f * radius))),
                  to = std::min(w - 1, static_cast<int>(std::max(-1.0f, cx + 2.0f * radius)));
        for (int x = from; x <= to; ++x) {
          const float dx = (static_cast<float>(x) - cx) / radius;
          const float spot = drop.light * exp_portable(-(dx * dx + dy * dy));
          const std::size_t i = static_cast<std::size_t>(x);
          cover[i] += spot;
          carried[i].x += spot * drop.velocity.x, carried[i].y += spot * drop.velocity.y;
        }
      }
      for (int x = 0; x < w; ++x) {
        const std::size_t i = static_cast<std::size_t>(x);
        if (cover[i] < 0.01f) continue;
        const float shown = 1.0f - exp_portable(-cover[i]);
        out[x] = mix(out[x], white_ * (0.6f + 0.5f * std::min(cover[i], 1.5f)), shown);
        a[x] = static_cast<std::uint8_t>(255.0f * shown + 0.5f);
        const float scale = height * second_ / cover[i];
        if (a[x] > 0) m[x] = {carried[i].x * scale, carried[i].y * scale};
      }
    });
  }

 private:
  std::vector<Drop> drops_at(float now) const {
    const Random random(seed_, 113);
    std::vector<Drop> drops;
    drops.reserve(jets_.size() * static_cast<std::size_t>(drops_));
    for (std::size_t j = 0; j < jets_.size(); ++j) {
      const Jet& jet = jets_[j];
      const float life = 2.0f * -jet.velocity.y / gravity_;
      for (int i = 0; i < drops_; ++i) {
        const std::uint64_t slot =
            (static_cast<std::uint64_t>(j) << 40) + (static_cast<std::uint64_t>(i) << 3);
        const float turns = now / life + random.at(slot) + 1.0f;
        const int turn = floor_int(turns);
        const float age = life * (turns - static_cast<float>(turn)), thrown = now - age;
        const std::uint64_t draw = slot + (static_cast<std::uint64_t>(turn) << 50);
        // The pump beats, and each throw has its own luck: round, from two draws a side.
        const float beat = 1.0f + 0.06f * noise_(2.3f * thrown, 3.0f * static_cast<float>(j) + 0.5f);
        const float speed = std::fabs(jet.velocity.y);
        const auto luck = [&](int k) {
          return random.at(draw + static_cast<std::uint64_t>(2 * k) + 1) +
                 random.at(draw + static_cast<std::uint64_t>(2 * k) + 2) - 1.0f;
        };
        const Vec2 thrown_at{jet.velocity.x + jet.spread * speed * luck(0),
                             jet.velocity.y * beat * (1.0f + 0.5f * jet.spread * (luck(1) - 1.0f))};
        const float grown = 0.5f + 0.9f * random.at(draw + 5);
        drops.push_back(
            {.place = {jet.x + thrown_at.x * age, jet.y + thrown_at.y * age + 0.5f * gravity_ * age * age},
             .velocity = {thrown_at.x, thrown_at.y + gravity_ * age},
             .light = 0.75f * random.at(draw + 6) + 0.1f,
             .radius = 0.0045f * zoom_ * grown});
      }
    }
    return drops;
  }

  cv::Size size_;
  Noise noise_;
  float second_, zoom_;  // seconds of a frame
  std::uint64_t seed_;
  float gravity_;  // heights per second^2
  std::vector<Jet> jets_;
  int drops_;  // of a jet, in the air
  Rgb white_, backdrop_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_fountain(const SceneOptions& options) {
  return std::make_unique<Fountain>(options);
}

}  // namespace freshet::synth::simulate
