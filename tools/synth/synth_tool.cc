#include <CLI/CLI.hpp>

#include "tools/commands.h"
#include "tools/judging/judge_tool.h"
#include "tools/tour/tour_tool.h"

namespace freshet::tools {

void add_synth(CLI::App& app, RunContext& context) {
  CLI::App* synth_command = app.add_subcommand(
      "synth", "Synthesise: animate a picture or some stills, simulate a fluid, or transfer a look");
  synth_command->require_subcommand(1);
  add_animate(*synth_command, context);
  add_sweep(*synth_command, context);
  add_judge(*synth_command, context);
  add_matte(*synth_command, context);
  add_simulate(*synth_command, context);
  add_stills(*synth_command, context);
  add_transfer(*synth_command, context);
  add_scene(*synth_command, context);
  add_layers(*synth_command, context);
  add_flowlines(*synth_command, context);
  add_tour(*synth_command, context);
}

}  // namespace freshet::tools
