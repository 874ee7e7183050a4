// tools/options/play_options.h — how the clips of an animation are played.
#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "synth/animate/frames/animation.h"
#include "synth/animate/staging.h"

namespace freshet::tools {

class PlayOptions {
 public:
  void add_to(CLI::App& command);
  /// Sets loop and memory.
  void apply(synth::animate::FrameOptions& options) const;
  /// As synth::takes::factor_of has it; empty: a factor was given.
  const std::string& pace() const { return pace_; }
  /// Reads the map and says what had to be changed about it. The factor is 1 where a pace is asked.
  synth::animate::Playing read(cv::Size picture) const;

 private:
  bool loop_ = false;
  double speed_ = 1;
  std::string pace_ = "auto";
  std::filesystem::path map_;
  int memory_mb_ = 2000;
};

}  // namespace freshet::tools
