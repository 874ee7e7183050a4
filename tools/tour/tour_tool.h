// tools/tour/tour_tool.h — freshet synth tour.
#pragma once

#include "tools/console/run_context.h"

namespace freshet::tools {

void add_tour(CLI::App& synth_command, RunContext& context);

}  // namespace freshet::tools
