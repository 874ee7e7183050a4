// synth/simulate/design/staged_design.cc — a design, simulated.
//
// The flow lives on cells, the fluid's density on the picture's pixels: its edges stay as sharp as the
// picture, however coarse the flow. An instant is shown before the steps that lead to the next one, and the
// way that those steps carry every pixel is its motion: what carries the alpha is what is written, to the
// last bit, except for the rounding of alpha.
#include <algorithm>
#include <vector>

#include "platform/random.h"
#include "synth/simulate/design/carried_fluid.h"
#include "synth/simulate/design/emitters.h"
#include "synth/simulate/design/fine_velocity.h"
#include "synth/simulate/design/forces.h"
#include "synth/simulate/design/obstacles.h"
#include "synth/simulate/design/placed_shape.h"
#include "synth/simulate/design/preview.h"
#include "synth/simulate/design/stage.h"
#include "synth/simulate/scene/simulated_scene.h"
#include "synth/simulate/solver/stable_fluids.h"

namespace freshet::synth::simulate {
namespace {

Edge edge_of(Side side) { return side == Side::kOpen ? Edge::kOpen : Edge::kFixed; }

Stage stage_of(const SceneOptions& options) {
  return {.picture = options.size,
          .cells = cells_of(options.design, options.size),
          .fps = options.fps,
          .step_s = static_cast<float>(1.0 / (options.fps * options.design.steps)),
          .clock_s = 0.0,
          .noise = Noise(options.seed)};
}

StableFluidsOptions flow_options(const Design& design, const Stage& stage) {
  const float rows = static_cast<float>(stage.cells.height);
  return {.left = edge_of(design.left),
          .right = edge_of(design.right),
          .top = edge_of(design.top),
          .bottom = edge_of(design.bottom),
          .confinement = design.fluid.vorticity * stage.step_s,
          .damping = std::min(1.0f, design.fluid.drag * stage.step_s),
          .viscosity = design.fluid.viscosity * stage.step_s * rows * rows,
          .max_speed = 0.25f * rows,
          // Pressure travels slowly between heavy and light.
          .projection = {.max_iterations = design.fluid.weight != 1.0f ? 30 : 12}};
}

/// Phases of noise [first, first + count), by the scene's seed.
std::vector<float> phases(std::uint64_t seed, std::size_t first, std::size_t count) {
  const Random random(seed, 201);
  std::vector<float> phases;
  for (std::size_t i = first; i < first + count; ++i) phases.push_back(60.0f * random.at(i));
  return phases;
}

class StagedDesign final : public Scene {
 public:
  explicit StagedDesign(const SceneOptions& options)
      : design_(options.design),
        stage_(stage_of(options)),
        flow_(stage_.cells.width, stage_.cells.height, flow_options(design_, stage_),
              GridOf<std::uint8_t>(stage_.cells.width, stage_.cells.height)),
        fine_velocity_(stage_.cells, stage_.picture),
        velocity_(stage_.picture.width, stage_.picture.height),
        fluid_(stage_.picture, stage_.cells),
        thick_(stage_.cells.width, stage_.cells.height),
        emitters_(design_.emitters, phases(options.seed, 0, design_.emitters.size()), stage_),
        obstacles_(design_.obstacles, stage_),
        forces_(design_.forces, phases(options.seed, design_.emitters.size(), design_.forces.size()), stage_),
        force_(stage_.cells.width, stage_.cells.height),
        growth_(thick_),
        lightness_(thick_),
        shown_{.density = fluid_.density,
               .obstacles = obstacles_.coverage(),
               .motion = VectorGrid(stage_.picture.width, stage_.picture.height),
               .emitters = cv::Mat(stage_.picture, CV_8U)} {
    const int warm_up = options.warm_up_frames >= 0 ? options.warm_up_frames : warm_up_frames();
    first_frame_s_ = static_cast<double>(warm_up) / stage_.fps;
    stage_.clock_s = -first_frame_s_;
    obstacles_.place(stage_, flow_);
    obstacles_.clear(fluid_.density);
    emitters_.feed(stage_, fluid_.density, fluid_.heat);
  }

  FilmOptions film() const override { return {.exposure = 1.0f, .bloom = 0.1f * design_.look.glow}; }
  int warm_up_frames() const override { return static_cast<int>(design_.warm_up_s * stage_.fps + 0.5); }

  void advance() override {
    shown_.density.values = fluid_.density.values;  // same sizes: no allocation
    shown_.obstacles.values = obstacles_.coverage().values;
    emitters_.show(stage_, shown_.emitters);
    std::fill(shown_.motion.values.begin(), shown_.motion.values.end(), Vec2{});
    for (int i = 0; i < design_.steps; ++i) {
      ++steps_done_;
      stage_.clock_s = static_cast<double>(steps_done_) / (stage_.fps * design_.steps) - first_frame_s_;
      step();
    }
  }

  void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat& emitters) override {
    shown_.emitters.copyTo(emitters);
    for (int y = 0; y < motion.rows; ++y)
      std::copy_n(shown_.motion.row(y), motion.cols, reinterpret_cast<Vec2*>(motion.ptr<float>(y)));
    draw_preview(design_.look, shown_.density, shown_.obstacles, alpha, film.light);
  }

 private:
  /// An instant, and where the steps after it carry its pixels.
  struct Shown {
    Grid density, obstacles;
    VectorGrid motion;  // px, until the next instant
    cv::Mat emitters;   // CV_8U
  };

  void step() {
    // The fluid goes along, and what is let in joins it.
    fine_velocity_.read(flow_.u(), flow_.v(), velocity_);
    carry_points(velocity_, shown_.motion);
    fluid_.carry_density(design_, stage_.step_s, velocity_);
    fluid_.carry_heat(design_.fluid, stage_.step_s, flow_.backtrace());
    obstacles_.place(stage_, flow_);
    obstacles_.clear(fluid_.density);
    emitters_.feed(stage_, fluid_.density, fluid_.heat);

    // Then the flow, by what is in its cells now.
    cell_means(fluid_.density, {{}, stage_.picture}, thick_);
    const CellContents cells{flow_.velocity(), thick_, fluid_.heat};
    set_body_forces(design_.fluid, stage_, cells, force_);
    forces_.add(stage_, cells, force_);
    emitters_.drive(stage_, flow_.velocity(), obstacles_.solid(), force_, growth_);
    if (design_.fluid.weight != 1.0f) {
      set_lightness(design_.fluid, thick_, lightness_);
      flow_.set_lightness(lightness_);
    }
    flow_.push(force_);
    flow_.step(nullptr, emitters_.grow() ? &growth_ : nullptr);
  }

  const Design design_;
  Stage stage_;
  StableFluids flow_;
  FineVelocity fine_velocity_;
  VectorGrid velocity_;  // px per step
  CarriedFluid fluid_;
  Grid thick_;  // density, mean of each cell
  Emitters emitters_;
  Obstacles obstacles_;
  Forces forces_;
  VectorGrid force_;
  Grid growth_, lightness_;
  Shown shown_;
  double first_frame_s_ = 0.0;
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
