// synth/simulate/clips/clouds.cc — a layer of cumulus that the wind drives over the camera, as in a
// time-lapse.
//
// No solver: the layer is a plane overhead, drawn in its own coordinates and moved as a whole, so that the
// motion field is exact perspective. Its shape also changes slowly, which no motion describes.
#include <algorithm>
#include <cmath>

#include "platform/random.h"
#include "synth/field/grid.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/noise.h"

namespace freshet::synth::simulate {
namespace {

class Clouds final : public Scene {
 public:
  explicit Clouds(const SceneOptions& options)
      : size_(options.size),
        noise_(options.seed),
        rate_(25.0f / static_cast<float>(options.fps)),
        density_(options.size.width, options.size.height),
        coarse_((options.size.width + 3) / 4 + 1, (options.size.height + 3) / 4 + 1) {
    Random random(options.seed, 106);
    horizon_ = random.between(1.35f, 2.6f);
    // 2 to 4.5 px per frame of 360 rows at a third of the height.
    const float speed = random.between(0.0055f, 0.0125f) * 1.4f / (horizon_ - 0.33f),
                turn = random.between(-0.09f, 0.09f);
    wind_ = {random.sign() * speed * cos_turns(turn) * rate_, speed * sin_turns(turn) * rate_};
    size_of_cloud_ = random.between(1.3f, 2.2f) * (horizon_ - 0.3f) / options.variation.zoom;
    wind_ = {options.variation.zoom * wind_.x, options.variation.zoom * wind_.y};
    clear_ = random.between(-0.12f, 0.3f) - 0.3f * (options.variation.amount - 1.0f);
    soft_ = random.between(0.25f, 0.55f);
    sun_ = {random.between(-0.25f, 0.25f), random.between(0.10f, 0.25f)};
    origin_ = {random.between(0.0f, 900.0f), random.between(0.0f, 900.0f)};
    // Noon, late light, or a grey day.
    const float mood = random.next();
    if (mood < 0.55f) {
      zenith_ = mix({0.03f, 0.12f, 0.42f}, {0.06f, 0.22f, 0.55f}, random.next());
      haze_ = {0.42f, 0.60f, 0.86f};
      lit_ = Rgb{1.25f, 1.22f, 1.18f} * random.between(0.9f, 1.1f);
      shade_ = {0.34f, 0.40f, 0.50f};
    } else if (mood < 0.82f) {
      zenith_ = mix({0.03f, 0.05f, 0.16f}, {0.09f, 0.07f, 0.18f}, random.next());
      haze_ = {0.70f, 0.33f, 0.16f};
      lit_ = Rgb{1.45f, 0.82f, 0.48f} * random.between(0.8f, 1.1f);
      shade_ = {0.20f, 0.15f, 0.22f};
    } else {
      zenith_ = {0.22f, 0.27f, 0.34f};
      haze_ = {0.50f, 0.54f, 0.58f};
      lit_ = Rgb{0.86f, 0.87f, 0.88f} * random.between(0.85f, 1.1f);
      shade_ = {0.12f, 0.14f, 0.17f};
      clear_ -= 0.2f;
    }
  }

  FilmOptions film() const override { return {.exposure = 0.85f, .bloom = 0.04f}; }
  int warm_up_frames() const override { return 0; }
  void advance() override { ++clock_; }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat&) override {
    const float time = static_cast<float>(clock_);
    const float h = static_cast<float>(size_.height);
    // Towards the sun, on a grid of 4 px: shadows inside a cloud are soft.
    for_rows(coarse_.height, [&](int y) {
      for (int x = 0; x < coarse_.width; ++x) {
        const Vec2 p = plane(static_cast<float>(4 * x), static_cast<float>(4 * y));
        float sum = 0.0f;
        for (int i = 1; i <= 3; ++i) {
          const float reach = 0.55f / size_of_cloud_ * static_cast<float>(i);
          sum += std::clamp(shape(p.x + sun_.x * reach, p.y + sun_.y * reach, time, 3) + clear_bias(), 0.0f,
                            1.2f);
        }
        coarse_(x, y) = sum / 3.0f;
      }
    });
    for_rows(size_.height, [&](int y) {
      for (int x = 0; x < size_.width; ++x) {
        const Vec2 p = plane(static_cast<float>(x), static_cast<float>(y));
        density_(x, y) = shape(p.x, p.y, time, 6) + clear_bias();
      }
    });
    for_rows(size_.height, [&](int y) {
      std::uint8_t* a = alpha.ptr<std::uint8_t>(y);
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      Rgb* out = film.light.row(y);
      const float fraction = (static_cast<float>(y) + 0.5f) / h;
      const float low = smoothstep(horizon_ - 1.7f, horizon_ + 0.1f, fraction);
      const Rgb sky = mix(zenith_, haze_, 0.05f + 0.8f * low);
      const float distance = depth(static_cast<float>(y));
      const float far = smoothstep(1.0f, 6.0f, distance) * 0.75f;
      const int above = std::max(y - 2, 0), below = std::min(y + 2, size_.height - 1);
      for (int x = 0; x < size_.width; ++x) {
        const float d = density_(x, y);
        const float cover = smoothstep(0.0f, soft_, d);
        const int left = std::max(x - 2, 0), right = std::min(x + 2, size_.width - 1);
        const float toward = bilinear(coarse_, static_cast<float>(x) * 0.25f, static_cast<float>(y) * 0.25f);
        const float slope = (density_(x, below) - density_(x, above)) +
                            0.6f * sun_.x * 4.0f * (density_(left, y) - density_(right, y));
        const float reached = exp_portable(-1.7f * std::max(0.0f, toward + 0.55f * d - 0.12f));
        const float light = std::clamp(reached * (1.0f + 1.5f * slope) + 0.12f * (1.0f - cover), 0.0f, 1.3f);
        const Rgb cloud = mix(mix(shade_, lit_, light), haze_, far);
        out[x] = mix(sky, cloud, cover * (1.0f - 0.35f * far));
        a[x] = static_cast<std::uint8_t>(255.0f * cover + 0.5f);
        m[x] = a[x] > 0 ? drift(static_cast<float>(x), static_cast<float>(y)) : Vec2{};
      }
    });
  }

 private:
  /// How far off the layer is along a row's sight, 1 straight above a horizon one picture height below.
  float depth(float y) const { return 1.0f / (horizon_ - (y + 0.5f) / static_cast<float>(size_.height)); }
  /// Picture to layer, layer heights.
  Vec2 plane(float x, float y) const {
    const float d = depth(y);
    return {(x - 0.5f * static_cast<float>(size_.width)) / static_cast<float>(size_.height) * d * 1.4f,
            d * 1.4f * horizon_};
  }
  /// px per frame: a point fixed in the layer, seen a frame later.
  Vec2 drift(float x, float y) const {
    const float h = static_cast<float>(size_.height);
    const Vec2 p = plane(x, y);
    const float later = (p.y + wind_.y) / (1.4f * horizon_);
    const float x_later = (p.x + wind_.x) / (later * 1.4f) * h + 0.5f * static_cast<float>(size_.width);
    const float y_later = (horizon_ - 1.0f / later) * h - 0.5f;
    return {x_later - x, y_later - y};
  }

  float clear_bias() const { return 0.05f - clear_; }
  float shape(float x, float y, float time, int octaves) const {
    const float u = (x - wind_.x * time + origin_.x) * size_of_cloud_,
                v = (y - wind_.y * time + origin_.y) * size_of_cloud_;
    const float warp = noise_(u * 0.7f + 3.0f, v * 0.7f);
    const float base = noise_.fractal(u + 0.35f * warp, v - 0.3f * warp, 2, 0.5f);
    // Folded noise puffs up where plain noise would be wavy.
    float puffs = 0.0f, amplitude = 0.62f, pitch = 2.3f;
    for (int i = 2; i < octaves; ++i) {
      const float n = noise_(u * pitch + 7.7f * static_cast<float>(i) + 0.4f * warp, v * pitch);
      puffs += amplitude * (0.32f - std::fabs(n));
      amplitude *= 0.62f, pitch *= 2.17f;
    }
    const float billow =
        octaves > 3 ? 0.16f * noise_.changing(u * 4.0f, v * 4.0f, 0.022f * time * rate_, 2) : 0.0f;
    return base + puffs + billow;
  }

  cv::Size size_;
  Noise noise_;
  float rate_;
  Grid density_, coarse_;
  float horizon_, size_of_cloud_, clear_, soft_;
  Vec2 wind_, sun_, origin_;
  Rgb zenith_, haze_, lit_, shade_;
  int clock_ = 0;
};

}  // namespace

std::unique_ptr<Scene> make_clouds(const SceneOptions& options) { return std::make_unique<Clouds>(options); }

}  // namespace freshet::synth::simulate
