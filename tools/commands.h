// tools/commands.h — the subcommands of freshet; each adds itself to the command line.
#pragma once

#include "tools/session.h"

namespace freshet::tools {

void add_ingest(CLI::App& app, Session& session);
void add_index(CLI::App& app, Session& session);
void add_store(CLI::App& app, Session& session);
void add_query(CLI::App& app, Session& session);
void add_synth(CLI::App& app, Session& session);

}  // namespace freshet::tools
