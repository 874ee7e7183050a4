// tools/options/play_options.h — how the clips of an animation are played.
#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "synth/animate/animate.h"
#include "synth/animate/placement/placement.h"

namespace freshet::tools {

class PlayOptions {
 public:
  void add_to(CLI::App& command);
  /// Sets loop, resampling and memory.
  void apply(synth::animate::AnimateOptions& options) const;
  /// Sets the patches' speeds. Reads the map and says what had to be changed about it.
  void apply(synth::animate::Placement& placement, cv::Size picture) const;

 private:
  bool loop_ = false;
  double speed_ = 1;
  std::filesystem::path map_;
  std::string resampling_ = "flow";
  int memory_mb_ = 2000;
};

}  // namespace freshet::tools
