// tools/options/duration.h — how long an animation is to be.
#pragma once

#include <CLI/CLI.hpp>

#include "query/search/candidates.h"

namespace freshet::tools {

/// How long the animation is to be; clips that are shorter are no candidates.
struct Duration {
  int frames = 96;
  double fps = 25;

  void add_to(CLI::App& command);
  double seconds() const { return frames / fps; }
};

/// Says what the filters left, and which clips were too short.
void say_filters(const query::Filtered& filtered, const Duration& duration);

}  // namespace freshet::tools
