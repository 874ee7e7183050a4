// tools/options/outline_options.h — whether the fluid's outline moves, and what lies behind it.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "media/video/picture_sink.h"
#include "synth/animate/animate.h"

namespace freshet::tools {

class OutlineOptions {
 public:
  void add_to(CLI::App& command);
  /// Throws Error{kUsage} for options of a moving outline with a still one.
  void check() const;
  /// Reads the background. Sets boundary and matte_sink of the options; the sink lives as long as this.
  void apply(synth::animate::AnimateOptions& options, cv::Size picture);
  /// After the last frame.
  void finish();
  const std::string& output() const { return matte_out_; }  // empty: none

 private:
  std::string kind_ = "static", background_, inpaint_ = "navier-stokes", matte_out_;
  synth::animate::DynamicMatteOptions matte_;
  const CLI::App* command_ = nullptr;
  std::unique_ptr<media::PictureSink> sink_;
};

}  // namespace freshet::tools
