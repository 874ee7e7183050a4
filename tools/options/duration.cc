#include "tools/options/duration.h"

#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/console/run_context.h"

namespace freshet::tools {

void Duration::add_to(CLI::App& command) {
  command
      .add_option("--frames", frames,
                  "Frames of the animation; clips that do not last as long play by their loop rules")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command.add_option("--fps", fps, "Frames per second of the animation")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
}

void say_filters(const query::Filtered& filtered, const Duration& duration) {
  std::string text;
  for (const query::FilterStep& step : filtered.steps)
    text += fmt::format("{}{}: {} patches of {} clips", text.empty() ? "" : "; ", step.what, step.patches,
                        step.clips);
  say(text);
  if (!filtered.too_short.empty())
    say(fmt::format("left out, as they do not last {:.2f} s ({} frames at {:g}/s) and have no loop rule: {}",
                    duration.seconds(), duration.frames, duration.fps, fmt::join(filtered.too_short, ", ")));
}

}  // namespace freshet::tools
