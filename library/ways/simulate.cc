#include "freshet/ways/simulate.h"

#include "library/opencv_threads.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/simulate/simulate.h"

namespace freshet {
namespace {

synth::simulate::SceneOptions scene_of(const SimulationOptions& options) {
  synth::simulate::SceneOptions scene = synth::simulate::named_scene(options.scene);
  scene.size = options.size.value_or(scene.size);
  scene.frames = options.frames.value_or(scene.frames);
  scene.fps = options.fps.value_or(scene.fps);
  scene.seed = options.seed.value_or(scene.seed);
  return scene;
}

}  // namespace

std::vector<std::string> simulation_presets() {
  std::vector<std::string> names;
  for (const synth::simulate::PresetScene& preset : synth::simulate::preset_scenes())
    names.push_back(preset.name);
  return names;
}

struct Simulation::Impl {
  explicit Impl(const SimulationOptions& options) : simulation(scene_of(options)) {}
  synth::simulate::Simulation simulation;
};

Simulation::Simulation(const SimulationOptions& options) {
  const OneOpenCvThread one;
  impl_ = std::make_unique<Impl>(options);
}
Simulation::~Simulation() = default;

cv::Size Simulation::size() const { return impl_->simulation.options().size; }
int Simulation::frames() const { return impl_->simulation.options().frames; }
double Simulation::fps() const { return impl_->simulation.options().fps; }

bool Simulation::next(SimulatedFrame& frame) {
  const OneOpenCvThread one;
  synth::simulate::SimulatedFrame own{frame.picture, frame.alpha, frame.motion, frame.emitters};
  if (!impl_->simulation.next(own)) return false;
  frame = {own.picture, own.alpha, own.motion, own.emitters};
  return true;
}

}  // namespace freshet
