// synth/simulate/design/staged_design.cc — a design, simulated.
//
// The flow lives on cells, the fluid's density on the picture's pixels: its edges stay as sharp as the
// picture, however coarse the flow. An instant is shown before the steps that lead to the next one, and the
// way that those steps carry every pixel is its motion: what carries the alpha is what is written, to the
// last bit, except for the rounding of alpha.
#include <algorithm>
#include <cmath>
#include <vector>

#include "platform/random.h"
#include "synth/field/portable_math.h"
#include "synth/simulate/design/fine_velocity.h"
#include "synth/simulate/design/shape.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/noise.h"
#include "synth/simulate/solver/stable_fluids.h"

namespace freshet::synth::simulate {
namespace {

Edge edge_of(Side side) { return side == Side::kOpen ? Edge::kOpen : Edge::kFixed; }

/// An emitter or obstacle as it lies now.
struct Placed {
  const Shape* shape;
  Vec2 shift{1e9f, 1e9f};
  cv::Rect bounds;
  Grid coverage, cells;  // of the picture; its mean over each cell
};

class StagedDesign final : public Scene {
 public:
  explicit StagedDesign(const SceneOptions& options)
      : design_(options.design),
        size_(options.size),
        fps_(options.fps),
        step_s_(static_cast<float>(1.0 / (options.fps * options.design.steps))),
        cells_(cells_of(options.design, options.size)),
        noise_(options.seed),
        flow_(cells_.width, cells_.height, flow_options(), GridOf<std::uint8_t>(cells_.width, cells_.height)),
        fine_velocity_(cells_, size_),
        velocity_(size_.width, size_.height),
        density_(size_.width, size_.height),
        next_density_(density_),
        shown_(density_),
        carried_(size_.width, size_.height),
        thick_(cells_.width, cells_.height),
        heat_(thick_),
        next_heat_(thick_),
        source_(thick_),
        lightness_(thick_),
        stream_(cells_.width + 1, cells_.height + 1),
        force_(cells_.width, cells_.height),
        solid_velocity_(cells_.width, cells_.height),
        solid_(cells_.width, cells_.height),
        obstacles_px_(size_.width, size_.height),
        shown_emitters_(size_, CV_8U),
        shown_obstacles_(obstacles_px_) {
    const int warm_up = options.warm_up_frames >= 0 ? options.warm_up_frames : warm_up_frames();
    first_frame_s_ = static_cast<double>(warm_up) / fps_;
    const auto placed = [&](const Shape& shape) {
      return Placed{.shape = &shape, .bounds = {}, .coverage = density_, .cells = thick_};
    };
    for (const Emitter& emitter : design_.emitters) emitters_.push_back(placed(emitter.shape));
    for (const Obstacle& obstacle : design_.obstacles) obstacles_.push_back(placed(obstacle.shape));
    const Random random(options.seed, 201);
    for (std::size_t i = 0; i < design_.emitters.size() + design_.forces.size(); ++i)
      phases_.push_back(60.0f * random.at(i));
    for (const Emitter& emitter : design_.emitters) blows_ |= emitter.expansion > 0.0f;
    clock_s_ = -first_frame_s_;
    place_obstacles();
    feed();
  }

  FilmOptions film() const override { return {.exposure = 1.0f, .bloom = 0.1f * design_.look.glow}; }
  int warm_up_frames() const override { return static_cast<int>(design_.warm_up_s * fps_ + 0.5); }

  void advance() override {
    shown_.values = density_.values;  // same sizes: no allocation
    shown_obstacles_.values = obstacles_px_.values;
    show_emitters();
    std::fill(carried_.values.begin(), carried_.values.end(), Vec2{});
    for (int i = 0; i < design_.steps; ++i) {
      ++steps_done_;
      clock_s_ = static_cast<double>(steps_done_) / (fps_ * design_.steps) - first_frame_s_;
      step();
    }
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat& emitters) override {
    const Look& look = design_.look;
    shown_emitters_.copyTo(emitters);
    const int w = size_.width, h = size_.height;
    const int reach = std::max(1, h / 180);
    for_rows(h, [&](int y) {
      Vec2* m = reinterpret_cast<Vec2*>(motion.ptr<float>(y));
      std::copy_n(carried_.row(y), w, m);
      const float* p = shown_.row(y);
      const float *above = shown_.row(std::max(y - reach, 0)),
                  *below = shown_.row(std::min(y + reach, h - 1));
      Rgb* out = film.light.row(y);
      for (int x = 0; x < w; ++x) {
        const float a = 1.0f - exp_portable(-look.opacity * p[x]);
        if (alpha.depth() == CV_16U)
          alpha.ptr<std::uint16_t>(y)[x] = static_cast<std::uint16_t>(a * 65535.0f + 0.5f);
        else
          alpha.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(a * 255.0f + 0.5f);
        const float solid = shown_obstacles_(x, y);
        const Rgb back = mix(Rgb{0.012f, 0.014f, 0.018f}, Rgb{0.11f, 0.1f, 0.09f}, solid);
        const int left = std::max(x - reach, 0), right = std::min(x + reach, w - 1);
        const float slope = (p[left] - p[right]) + (below[x] - above[x]);
        const float lit = std::clamp(0.62f + 0.3f * slope, 0.15f, 1.0f);
        const Rgb colour = mix(look.thin, look.dense, std::min(p[x], 1.0f));
        const Rgb lamp = colour * (lit * a), flame = colour * (2.5f * p[x]);
        out[x] = mix(mix(back, lamp + back * (1.0f - a), 1.0f - look.glow), back + flame, look.glow);
      }
    });
  }

 private:
  StableFluidsOptions flow_options() const {
    const float rows = static_cast<float>(cells_.height);
    return {.left = edge_of(design_.left),
            .right = edge_of(design_.right),
            .top = edge_of(design_.top),
            .bottom = edge_of(design_.bottom),
            .confinement = design_.fluid.vorticity * step_s_,
            .damping = std::min(1.0f, design_.fluid.drag * step_s_),
            .viscosity = design_.fluid.viscosity * step_s_ * rows * rows,
            .max_speed = 0.25f * rows,
            // Pressure travels slowly between heavy and light.
            .projection = {.max_iterations = design_.fluid.weight != 1.0f ? 30 : 12}};
  }
  /// Cells per step for one height per second.
  float speed_unit() const { return static_cast<float>(cells_.height) * step_s_; }

  void step() {
    fine_velocity_.read(flow_.u(), flow_.v(), velocity_);
    carry_pixels();
    advect_density();
    advect_heat();
    place_obstacles();
    feed();
    reduce(density_, {0, 0, size_.width, size_.height}, thick_);
    push();
    if (design_.fluid.weight != 1.0f) weigh();
    flow_.push(force_);
    flow_.step(nullptr, blows_ ? &source_ : nullptr);
  }

  /// Where the content of each pixel of the shown instant has come by now.
  void carry_pixels() {
    for_rows(size_.height, [&](int y) {
      Vec2* c = carried_.row(y);
      for (int x = 0; x < size_.width; ++x) {
        const float at_x = static_cast<float>(x) + c[x].x, at_y = static_cast<float>(y) + c[x].y;
        const Vec2 v = bilinear(velocity_, at_x, at_y);
        const Vec2 half = bilinear(velocity_, at_x + 0.5f * v.x, at_y + 0.5f * v.y);
        c[x] = {c[x].x + half.x, c[x].y + half.y};
      }
    });
  }

  void advect_density() {
    const FluidOptions& f = design_.fluid;
    const float kept = std::max(0.0f, 1.0f - f.dissipation * step_s_), burnt = f.burning * step_s_;
    const float last_x = static_cast<float>(size_.width - 1), last_y = static_cast<float>(size_.height - 1);
    for_rows(size_.height, [&](int y) {
      const Vec2* v = velocity_.row(y);
      float* out = next_density_.row(y);
      for (int x = 0; x < size_.width; ++x) {
        const float px = static_cast<float>(x), py = static_cast<float>(y);
        const Vec2 half = bilinear(velocity_, px - 0.5f * v[x].x, py - 0.5f * v[x].y);
        const float from_x = px - half.x, from_y = py - half.y;
        float value = bicubic_limited(density_, from_x, from_y);
        // Clear air comes in through open sides.
        if (design_.left == Side::kOpen) value *= std::clamp(1.0f + from_x, 0.0f, 1.0f);
        if (design_.right == Side::kOpen) value *= std::clamp(1.0f + last_x - from_x, 0.0f, 1.0f);
        if (design_.top == Side::kOpen) value *= std::clamp(1.0f + from_y, 0.0f, 1.0f);
        if (design_.bottom == Side::kOpen) value *= std::clamp(1.0f + last_y - from_y, 0.0f, 1.0f);
        out[x] = std::max(0.0f, value * kept - burnt);
      }
    });
    std::swap(density_, next_density_);
  }

  void advect_heat() {
    const float kept = std::max(0.0f, 1.0f - design_.fluid.cooling * step_s_);
    for_rows(heat_.height, [&](int y) {
      for (int x = 0; x < heat_.width; ++x) {
        const Vec2 back = flow_.backtrace()(x, y);
        next_heat_(x, y) =
            kept * bicubic_limited(heat_, static_cast<float>(x) + back.x, static_cast<float>(y) + back.y);
      }
    });
    std::swap(heat_, next_heat_);
  }

  /// Means of a picture's field over the cells that touch `bounds`.
  void reduce(const Grid& field, cv::Rect bounds, Grid& cells) const {
    const auto first = [](int cell, int count, int pixels) {
      return static_cast<int>(static_cast<std::int64_t>(cell) * pixels / count);
    };
    for_rows(cells.height, [&](int y) {
      const int y0 = first(y, cells.height, size_.height),
                y1 = std::max(y0 + 1, first(y + 1, cells.height, size_.height));
      if (y1 <= bounds.y || y0 >= bounds.y + bounds.height) return;
      for (int x = 0; x < cells.width; ++x) {
        const int x0 = first(x, cells.width, size_.width),
                  x1 = std::max(x0 + 1, first(x + 1, cells.width, size_.width));
        if (x1 <= bounds.x || x0 >= bounds.x + bounds.width) continue;
        float sum = 0.0f;
        for (int j = y0; j < y1; ++j) {
          const float* p = field.row(j);
          for (int i = x0; i < x1; ++i) sum += p[i];
        }
        cells(x, y) = sum / static_cast<float>((y1 - y0) * (x1 - x0));
      }
    });
  }

  /// Draws the shape where it now is. True when it has moved.
  bool place(Placed& placed) {
    const Vec2 shift = shift_at(*placed.shape, clock_s_);
    if (shift.x == placed.shift.x && shift.y == placed.shift.y) return false;
    placed.shift = shift;
    placed.bounds = draw_shape(*placed.shape, shift, placed.coverage);
    std::fill(placed.cells.values.begin(), placed.cells.values.end(), 0.0f);
    reduce(placed.coverage, placed.bounds, placed.cells);
    return true;
  }

  void place_obstacles() {
    if (obstacles_.empty()) return;
    bool changed = false;
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      changed |= place(obstacles_[i]);
      const bool there = design_.obstacles[i].span.holds(clock_s_);
      const bool was = steps_done_ > 0 && design_.obstacles[i].span.holds(clock_s_ - step_s_);
      // One more step after it came to rest, to take its velocity away.
      changed |= there != was || !obstacles_[i].shape->move.empty();
    }
    if (changed || steps_done_ == 0) set_obstacles();
    for_rows(size_.height, [&](int y) {
      const float* solid = obstacles_px_.row(y);
      float* p = density_.row(y);
      for (int x = 0; x < size_.width; ++x) p[x] *= 1.0f - solid[x];
    });
  }

  void set_obstacles() {
    std::fill(obstacles_px_.values.begin(), obstacles_px_.values.end(), 0.0f);
    std::fill(solid_.values.begin(), solid_.values.end(), std::uint8_t{0});
    std::fill(solid_velocity_.values.begin(), solid_velocity_.values.end(), Vec2{});
    for (std::size_t i = 0; i < obstacles_.size(); ++i) {
      if (!design_.obstacles[i].span.holds(clock_s_)) continue;
      const Placed& placed = obstacles_[i];
      const Vec2 before = shift_at(*placed.shape, clock_s_ - step_s_);
      const Vec2 speed{(placed.shift.x - before.x) * static_cast<float>(cells_.width),
                       (placed.shift.y - before.y) * static_cast<float>(cells_.height)};
      for (std::size_t k = 0; k < solid_.values.size(); ++k) {
        if (placed.cells.values[k] < 0.5f) continue;
        solid_.values[k] = 1;
        solid_velocity_.values[k] = speed;
      }
      const cv::Rect& b = placed.bounds;
      for (int y = b.y; y < b.y + b.height; ++y) {
        for (int x = b.x; x < b.x + b.width; ++x)
          obstacles_px_(x, y) = std::max(obstacles_px_(x, y), placed.coverage(x, y));
      }
    }
    flow_.set_solid(solid_, solid_velocity_);
  }

  /// How much of its rate an emitter gives now; 0 when it is off.
  float rate_now(std::size_t i) const {
    const Emitter& emitter = design_.emitters[i];
    return emitter.span.holds(clock_s_) ? std::max(0.0f, value_at(emitter.rate, clock_s_)) : 0.0f;
  }

  float noise_time() const { return static_cast<float>(clock_s_ + 512.0); }

  void feed() {
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
      const float rate = rate_now(i);
      if (rate <= 0.0f) continue;
      const Emitter& emitter = design_.emitters[i];
      Placed& placed = emitters_[i];
      place(placed);
      // Lumps of driven fluid change across its way and with time, never along it: what passes through the
      // shape takes the most of what it meets in a few steps, which would show as scallops one step apart.
      const float pitch = 1.0f / (emitter.lump * static_cast<float>(size_.height));
      const Vec2 v = emitter.velocity;
      const float speed = std::sqrt(v.x * v.x + v.y * v.y), time = noise_time();
      const float boil =
          time * std::min(1.0f + 0.7f * speed / emitter.lump, 0.25f * static_cast<float>(fps_));
      const Vec2 across = speed > 0.0f ? Vec2{-v.y / speed * pitch, v.x / speed * pitch} : Vec2{};
      const auto lump_at = [&](int x, int y) {
        const float px = static_cast<float>(x), py = static_cast<float>(y);
        const float n = speed > 0.0f
                            ? noise_.fractal(px * across.x + py * across.y + phases_[i], boil, 2)
                            : noise_.changing(px * pitch + phases_[i], py * pitch - phases_[i], boil, 2);
        return std::clamp(1.0f + emitter.jitter * (1.6f * n - 0.2f), 0.25f, 1.6f);
      };
      const cv::Rect& b = placed.bounds;
      for_rows(b.height, [&](int row) {
        const int y = b.y + row;
        const float* c = placed.coverage.row(y);
        float* p = density_.row(y);
        for (int x = b.x; x < b.x + b.width; ++x) {
          if (c[x] <= 0.0f) continue;
          const float lump = emitter.jitter > 0.0f ? lump_at(x, y) : 1.0f;
          p[x] = std::max(p[x], rate * c[x] * lump);
        }
      });
      if (emitter.heat <= 0.0f) continue;
      const float gust = 1.0f + emitter.jitter * noise_(1.3f * time, phases_[i] + 4.5f);
      const float heat = emitter.heat * std::min(rate, 1.0f) * std::max(0.0f, gust);
      for (std::size_t k = 0; k < heat_.values.size(); ++k)
        heat_.values[k] = std::max(heat_.values[k], heat * placed.cells.values[k]);
    }
  }

  void show_emitters() {
    shown_emitters_.setTo(0);
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
      if (rate_now(i) <= 0.0f) continue;
      const Placed& placed = emitters_[i];
      const cv::Rect& b = placed.bounds;
      for (int y = b.y; y < b.y + b.height; ++y) {
        std::uint8_t* out = shown_emitters_.ptr<std::uint8_t>(y);
        for (int x = b.x; x < b.x + b.width; ++x)
          out[x] = std::max(out[x], static_cast<std::uint8_t>(255.0f * placed.coverage(x, y) + 0.5f));
      }
    }
  }

  /// Heavy fluid keeps its way through air that gives way.
  void weigh() {
    const float light = 1.0f / design_.fluid.weight;
    for_rows(cells_.height, [&](int y) {
      for (int x = 0; x < cells_.width; ++x)
        lightness_(x, y) = light / lerp(light, 1.0f, std::min(thick_(x, y), 1.0f));
    });
    flow_.set_lightness(lightness_);
  }

  void push() {
    const FluidOptions& f = design_.fluid;
    const float pull = speed_unit() * step_s_;  // cells per step per step, for 1 height/s^2
    const float still = std::min(1.0f, f.still_air * step_s_), light = 1.0f / f.weight;
    const float brake = f.top_speed > 0.0f
                            ? std::max(f.buoyancy, f.gravity) /
                                  (f.top_speed * f.top_speed * static_cast<float>(cells_.height))
                            : 0.0f;
    for_rows(cells_.height, [&](int y) {
      for (int x = 0; x < cells_.width; ++x) {
        const Vec2 v = flow_.velocity()(x, y);
        const float thick = std::min(thick_(x, y), 1.0f);
        const float drag = still * (1.0f - std::min(1.0f, 4.0f * thick)) +
                           std::min(0.5f, brake * std::sqrt(v.x * v.x + v.y * v.y));
        const float fall = f.gravity * thick / lerp(light, 1.0f, thick);  // the air in a cell weighs little
        force_(x, y) = {-drag * v.x, pull * (fall - f.buoyancy * heat_(x, y)) - drag * v.y};
      }
    });
    for (std::size_t i = 0; i < design_.forces.size(); ++i)
      if (design_.forces[i].span.holds(clock_s_))
        add(design_.forces[i], phases_[design_.emitters.size() + i], pull);
    drive();
  }

  /// Emitters drive what is in them, and blow it up.
  void drive() {
    if (blows_) std::fill(source_.values.begin(), source_.values.end(), 0.0f);
    const float unit = speed_unit(), time = noise_time();
    for (std::size_t i = 0; i < emitters_.size(); ++i) {
      const float rate = rate_now(i);
      if (rate <= 0.0f) continue;
      const Emitter& e = design_.emitters[i];
      const Placed& placed = emitters_[i];
      const float gust = 1.0f + 0.6f * e.jitter * noise_(1.7f * time, phases_[i] + 0.5f),
                  sway = 0.06f * e.jitter * noise_(1.1f * time, phases_[i] + 20.5f);
      const float s = sin_turns(sway), c = cos_turns(sway);
      const Vec2 asked{unit * gust * (c * e.velocity.x - s * e.velocity.y),
                       unit * gust * (s * e.velocity.x + c * e.velocity.y)};
      const bool driven = e.velocity.x != 0.0f || e.velocity.y != 0.0f;
      const float growth = e.expansion * step_s_ * std::min(rate, 1.0f);
      for_rows(cells_.height, [&](int y) {
        for (int x = 0; x < cells_.width; ++x) {
          const float fraction = placed.cells(x, y);
          if (fraction <= 0.0f) continue;
          const Vec2 v = flow_.velocity()(x, y);
          if (driven) {
            force_(x, y).x += fraction * (asked.x - v.x);
            force_(x, y).y += fraction * (asked.y - v.y);
          }
          if (growth > 0.0f && solid_(x, y) == 0) source_(x, y) += growth * fraction;
        }
      });
    }
  }

  void add(const Force& force, float phase, float pull) {
    const float rows = static_cast<float>(cells_.height);
    if (force.kind == Force::Kind::kWind) {
      const Vec2 wind{force.velocity.x * speed_unit(), force.velocity.y * speed_unit()};
      const float fraction = std::min(1.0f, force.strength * step_s_);
      for_rows(cells_.height, [&](int y) {
        for (int x = 0; x < cells_.width; ++x) {
          const Vec2 v = flow_.velocity()(x, y);
          force_(x, y).x += fraction * (wind.x - v.x), force_(x, y).y += fraction * (wind.y - v.y);
        }
      });
      return;
    }
    if (force.kind == Force::Kind::kTurbulence) {
      const float pitch = 1.0f / (force.size * rows), time = force.change * noise_time();
      for_rows(stream_.height, [&](int y) {
        for (int x = 0; x < stream_.width; ++x) {
          stream_(x, y) = noise_.changing(static_cast<float>(x) * pitch + phase,
                                          static_cast<float>(y) * pitch - phase, time, 2);
        }
      });
      const float scale = force.strength * pull * force.size * rows;
      for_rows(cells_.height, [&](int y) {
        for (int x = 0; x < cells_.width; ++x) {
          const float a = force.in_fluid_only ? scale * std::min(1.0f, 3.0f * thick_(x, y)) : scale;
          force_(x, y).x += a * (stream_(x, y + 1) - stream_(x, y));
          force_(x, y).y -= a * (stream_(x + 1, y) - stream_(x, y));
        }
      });
      return;
    }
    const Vec2 middle{force.position.x * static_cast<float>(cells_.width) - 0.5f,
                      force.position.y * rows - 0.5f};
    const float reach = force.radius * rows, strength = force.strength * pull;
    const bool turns = force.kind == Force::Kind::kVortex;
    for_rows(cells_.height, [&](int y) {
      for (int x = 0; x < cells_.width; ++x) {
        const float dx = (static_cast<float>(x) - middle.x) / reach,
                    dy = (static_cast<float>(y) - middle.y) / reach;
        // r exp((1 - r^2) / 2): 0 in the middle, 1 at the radius.
        const float scale = strength * exp_portable(0.5f * (1.0f - dx * dx - dy * dy));
        force_(x, y).x += turns ? scale * dy : -scale * dx;
        force_(x, y).y += turns ? -scale * dx : -scale * dy;
      }
    });
  }

  const Design design_;
  cv::Size size_;
  double fps_;
  float step_s_;
  cv::Size cells_;
  Noise noise_;
  StableFluids flow_;
  FineVelocity fine_velocity_;
  VectorGrid velocity_;  // px per step
  Grid density_, next_density_, shown_;
  VectorGrid carried_;
  Grid thick_;  // density, mean of each cell
  Grid heat_, next_heat_, source_, lightness_, stream_;
  VectorGrid force_, solid_velocity_;
  GridOf<std::uint8_t> solid_;
  Grid obstacles_px_;
  cv::Mat shown_emitters_;
  Grid shown_obstacles_;
  std::vector<Placed> emitters_, obstacles_;
  std::vector<float> phases_;
  bool blows_ = false;
  double first_frame_s_ = 0.0, clock_s_ = 0.0;
  std::int64_t steps_done_ = 0;
};

}  // namespace

cv::Size cells_of(const Design& design, cv::Size picture) {
  const double columns = static_cast<double>(design.rows) * picture.width / picture.height;
  return {std::max(4, static_cast<int>(columns + 0.5)), design.rows};
}

std::unique_ptr<Scene> make_design(const SceneOptions& options) {
  return std::make_unique<StagedDesign>(options);
}

}  // namespace freshet::synth::simulate
