// tools/options/hold_options.h — what stands in front of the fluid or beside it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "tools/options/target_files.h"

namespace freshet::tools {

class HoldOptions {
 public:
  /// --hold.
  void add_to(CLI::App& command);
  /// Takes what stands out of the target's matte, and says how much that was.
  /// Returns  what is held, CV_8U of the picture's size; empty without --hold, or where `auto` finds nothing.
  /// Throws   as media::read_matte, and Error{kInput} when hardly anything of the matte is left.
  cv::Mat take_out(TargetFiles::Loaded& loaded) const;

 private:
  std::string hold_;
};

}  // namespace freshet::tools
