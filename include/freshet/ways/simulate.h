// include/freshet/ways/simulate.h — a fluid's designed motion, or a rendered clip of one, frame by frame.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet {

struct SimulationOptions {
  /// A preset, one of simulation_presets(), or the path of a scene file (.toml).
  std::string scene = "plume";
  /// px, 16 to 4096 each way. Nothing, here and below: the scene's.
  std::optional<cv::Size> size{};
  /// At least 1.
  std::optional<int> frames{};
  /// Frames per second, 1 to 240.
  std::optional<double> fps{};
  /// Another seed, another scene of the same kind.
  std::optional<std::uint64_t> seed{};
};

struct SimulatedFrame {
  cv::Mat picture;   // CV_8UC3 BGR
  cv::Mat alpha;     // CV_8U: how much of the pixel the fluid covers, straight
  cv::Mat motion;    // CV_32FC2, px per frame, x right, y down: what lies at p lies at p + motion in the next
  cv::Mat emitters;  // CV_8U: 255 where a design's emitters hold fluid; black in clips
};

/// Names: designs first (plume, fireball, ...), then ready-made clips (smoke, fire, ink, waterfall, ...).
std::vector<std::string> simulation_presets();

/// Same options, same bytes: for any number of threads and on every x86-64.
///
///   Simulation clip({.scene = "fire", .seed = 7});
///   for (SimulatedFrame frame; clip.next(frame);) video.write(frame.picture);
class Simulation {
 public:
  /// Throws Error{kUsage} for an unknown preset or options out of range, Error{kInput} for a scene file that
  /// is missing or wrong.
  explicit Simulation(const SimulationOptions& options);
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  ~Simulation();

  cv::Size size() const;
  int frames() const;
  double fps() const;
  /// Frame 0, then 1, ... false, and frame untouched, after the last. Mats of the right size and type are
  /// written in place: clone what must outlive the next call.
  bool next(SimulatedFrame& frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet
