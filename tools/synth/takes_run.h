// tools/synth/takes_run.h — takes of an animation, tried before it is made.
#pragma once

#include <optional>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "store/store.h"
#include "synth/takes/trial.h"
#include "tools/console/run_context.h"
#include "tools/synth/animate_command.h"

namespace freshet::tools {

/// What takes may vary: what no option of the command line says.
synth::takes::Open open_of(const CLI::App& given);

/// Tries takes, says which is best and why, and changes the inputs to it. Nothing where there is but one to try.
/// kind   of the fluid, a store's class.
std::optional<synth::takes::Trial> choose_take(const store::Snapshot& snapshot, AnimateInputs& inputs,
                                               const query::Assignment& assignment, const std::string& kind,
                                               int count, const synth::takes::Open& open,
                                               const RunContext& context);

/// {"seconds", "side", "takes": [{"name", "options", "faults", "why", "chosen"}]}; null without a trial.
nlohmann::json takes_json(const std::optional<synth::takes::Trial>& trial);

}  // namespace freshet::tools
