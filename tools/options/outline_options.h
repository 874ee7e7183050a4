// tools/options/outline_options.h — whether the fluid's outline moves, and what lies behind it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "synth/animate/frames/animation.h"

namespace freshet::tools {

class OutlineOptions {
 public:
  void add_to(CLI::App& command);
  /// Throws Error{kUsage} for options of a moving outline with a still one.
  void check() const;
  /// Reads the background. Sets outline of the options.
  void apply(synth::animate::FrameOptions& options, cv::Size picture) const;

 private:
  std::string kind_ = "static", background_, inpaint_ = "navier-stokes";
  synth::outline::DynamicMatteOptions matte_;
  const CLI::App* command_ = nullptr;
};

}  // namespace freshet::tools
