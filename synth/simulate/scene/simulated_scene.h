// synth/simulate/scene/simulated_scene.h — the interface of what can be simulated: ten clips, and designs.
#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "synth/simulate/scene/scene_options.h"
#include "synth/simulate/solver/film.h"

namespace freshet::synth::simulate {

class Scene {
 public:
  virtual ~Scene() = default;
  virtual FilmOptions film() const = 0;
  virtual int warm_up_frames() const = 0;
  /// Moves on by one frame.
  virtual void advance() = 0;
  /// The present instant. All of film.light, alpha (CV_8U; CV_16U when the options ask for 16 bits) and
  /// motion (CV_32FC2, from this instant to the next, px per frame) is overwritten. emitters (CV_8U) comes in
  /// black: designs draw in it where fluid enters. All have the picture's size.
  virtual void render(Film& film, cv::Mat& alpha, cv::Mat& motion, cv::Mat& emitters) = 0;
};

std::unique_ptr<Scene> make_smoke(const SceneOptions& options);
std::unique_ptr<Scene> make_fire(const SceneOptions& options);
std::unique_ptr<Scene> make_ink(const SceneOptions& options);
std::unique_ptr<Scene> make_waterfall(const SceneOptions& options);
std::unique_ptr<Scene> make_river(const SceneOptions& options);
std::unique_ptr<Scene> make_clouds(const SceneOptions& options);
std::unique_ptr<Scene> make_sea(const SceneOptions& options);
std::unique_ptr<Scene> make_rain(const SceneOptions& options);
std::unique_ptr<Scene> make_fountain(const SceneOptions& options);
std::unique_ptr<Scene> make_breakers(const SceneOptions& options);
std::unique_ptr<Scene> make_design(const SceneOptions& options);

}  // namespace freshet::synth::simulate
