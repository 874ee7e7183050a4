// synth/simulate/simulate.h — a clip of a simulated fluid, frame by frame.
#pragma once

#include <memory>

#include <opencv2/core.hpp>

#include "synth/simulate/scene/scene_options.h"

namespace freshet::synth::simulate {

struct SimulatedFrame {
  /// CV_8UC3 BGR, sRGB-like gamma, over the scene's own background, which never changes except for grain.
  cv::Mat picture;
  /// CV_8U, or CV_16U if asked for: how much of the pixel the fluid covers, straight.
  cv::Mat alpha;
  /// CV_32FC2, px per frame, x right, y down: what lies at p now lies at p + motion in the next frame. In
  /// clips 0 where alpha is 0.
  cv::Mat motion;
  /// CV_8U: 255 where a design's emitters hold the fluid they let in; black in clips.
  cv::Mat emitters;
};

/// The camera stands still. Same options, same bytes: for any number of threads and on every x86-64.
///
///   Simulation clip({.kind = SceneKind::kFire, .seed = 7});
///   SimulatedFrame frame;
///   while (clip.next(frame)) writer.write(frame.picture);
///
/// Cost  processor time per frame of 640 x 360, ms (a busy 2-core machine, seed 5, 30 frames), and of the
///       warm-up, s. Nearly all of it runs on every core:
///         smoke 56, 2.6   fire 48, 1.3   ink 49, 4.2   waterfall 34, 0.1   river 89, 1.6   clouds 46, 0.1
class Simulation {
 public:
  /// Throws Error{kUsage} for options out of range (see check()). Runs the warm-up.
  explicit Simulation(const SceneOptions& options);
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;
  ~Simulation();

  /// Frame 0, then 1, ... false, and frame untouched, after the last. Mats of the right size and type are
  /// written in place: clone what must outlive the next call.
  bool next(SimulatedFrame& frame);

  const SceneOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::simulate
