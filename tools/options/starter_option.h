// tools/options/starter_option.h — the store of a command that was given none.
#pragma once

#include <filesystem>

#include "tools/console/run_context.h"

namespace freshet::tools {

/// The starter store in the user's cache, made at the first call with progress; says so. Throws as
/// starter::make_store, and Error{kUsage} where there is no home.
std::filesystem::path starter_store(const RunContext& context);

/// Throws Error{kDamaged} for a store that is damaged.
bool is_store(const std::filesystem::path& path);

}  // namespace freshet::tools
