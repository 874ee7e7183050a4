// tools/synth/animate_run.h — freshet synth animate, asked for by another command.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "hints/strokes.h"
#include "tools/console/run_context.h"
#include "tools/options/target_files.h"

namespace freshet::tools {

/// What is animated, and for how long.
struct AnimateRequest {
  TargetFiles::Loaded loaded;
  std::string store;
  /// Options of freshet synth animate, word by word, but for its files and its length.
  std::vector<std::string> words{};
  /// Drawn elsewhere; those that the words name stand above them.
  std::vector<hints::Stroke> strokes{};
  int frames = 96;
  double fps = 25;
  bool loop = false;
  std::string where{};  // what asks, for messages
};

/// Hands every frame to `sink`, in order: CV_32FC4, the fluid's colours times its matte, and the matte.
/// motion   may be empty; else it is given that of each frame, before it: CV_32FC2, px until the next frame, x right, y
///          down.
/// Throws what the command throws; Error{kUsage} naming `where` for words that it does not know.
void animate_layer(const AnimateRequest& request, const std::function<void(const cv::Mat&)>& sink,
                   const std::function<void(const cv::Mat&)>& motion, const RunContext& context);

}  // namespace freshet::tools
