// tools/judging/judge_tool.h — freshet synth judge, which adds itself to the command line.
#pragma once

#include <CLI/CLI.hpp>

#include "tools/console/run_context.h"

namespace freshet::tools {

void add_judge(CLI::App& synth_command, RunContext& context);

}  // namespace freshet::tools
