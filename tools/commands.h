// tools/commands.h — the subcommands of freshet; each adds itself to the command line.
#pragma once

#include "tools/console/run_context.h"

namespace freshet::tools {

void add_ingest(CLI::App& app, RunContext& context);
void add_index(CLI::App& app, RunContext& context);
void add_store(CLI::App& app, RunContext& context);
void add_query(CLI::App& app, RunContext& context);
void add_synth(CLI::App& app, RunContext& context);
void add_work(CLI::App& app, RunContext& context);
void add_studio(CLI::App& app, RunContext& context);

// Of freshet store: repair, compact, remove, merge.
void add_store_rewrites(CLI::App& store_command, RunContext& context);
// Of freshet store: page.
void add_store_page(CLI::App& store_command, RunContext& context);

// Of freshet query.
void add_bench(CLI::App& query_command, RunContext& context);

// Of freshet synth.
void add_animate(CLI::App& synth_command, RunContext& context);
void add_sweep(CLI::App& synth_command, RunContext& context);
void add_matte(CLI::App& synth_command, RunContext& context);
void add_simulate(CLI::App& synth_command, RunContext& context);
void add_stills(CLI::App& synth_command, RunContext& context);
void add_transfer(CLI::App& synth_command, RunContext& context);
void add_scene(CLI::App& synth_command, RunContext& context);
void add_layers(CLI::App& synth_command, RunContext& context);
void add_flowlines(CLI::App& synth_command, RunContext& context);

}  // namespace freshet::tools
