// synth/simulate/simulate.cc
#include "synth/simulate/simulate.h"

#include <algorithm>
#include <cmath>

#include "synth/simulate/scene/simulated_scene.h"

namespace freshet::synth::simulate {
namespace {

/// Steps of a scene for each frame: a fluid that is faster is the same one, solved further.
int steps_of(const ClipVariation& variation) {
  return std::max(1, static_cast<int>(std::ceil(variation.speed)));
}

std::unique_ptr<Scene> make_scene(const SceneOptions& given) {
  check(given);
  SceneOptions options = given;
  options.fps = given.fps * steps_of(given.variation) / static_cast<double>(given.variation.speed);
  switch (options.kind) {
    case SceneKind::kSmoke:
      return make_smoke(options);
    case SceneKind::kFire:
      return make_fire(options);
    case SceneKind::kInk:
      return make_ink(options);
    case SceneKind::kWaterfall:
      return make_waterfall(options);
    case SceneKind::kRiver:
      return make_river(options);
    case SceneKind::kClouds:
      return make_clouds(options);
    case SceneKind::kSea:
      return make_sea(options);
    case SceneKind::kRain:
      return make_rain(options);
    case SceneKind::kFountain:
      return make_fountain(options);
    case SceneKind::kBreakers:
      return make_breakers(options);
    case SceneKind::kDesign:
      return make_design(options);
  }
  return nullptr;
}

}  // namespace

struct Simulation::Impl {
  SceneOptions options;
  std::unique_ptr<Scene> scene;
  Film film;
  int steps, frame = 0;

  explicit Impl(const SceneOptions& given)
      : options(given),
        scene(make_scene(given)),
        film(given.size, scene->film(), given.seed),
        steps(steps_of(given.variation)) {
    advance(options.warm_up_frames >= 0 ? options.warm_up_frames * steps : scene->warm_up_frames());
  }
  void advance(int count) {
    for (int i = 0; i < count; ++i) scene->advance();
  }
};

Simulation::Simulation(const SceneOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

bool Simulation::next(SimulatedFrame& frame) {
  Impl& m = *impl_;
  if (m.frame >= m.options.frames) return false;
  m.advance(m.steps);
  frame.alpha.create(m.options.size, m.options.alpha_bits == 16 ? CV_16U : CV_8U);
  frame.motion.create(m.options.size, CV_32FC2);
  frame.emitters.create(m.options.size, CV_8U);
  frame.emitters.setTo(0);
  m.scene->render(m.film, frame.alpha, frame.motion, frame.emitters);
  if (m.steps > 1) frame.motion *= m.steps;
  m.film.develop(m.frame, frame.picture);
  ++m.frame;
  return true;
}

const SceneOptions& Simulation::options() const { return impl_->options; }

}  // namespace freshet::synth::simulate
