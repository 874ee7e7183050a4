// tools/console/index_progress.h — bringing a store's index up to date, with its progress shown.
#pragma once

#include <string>
#include <vector>

#include "query/index/index_builder.h"
#include "store/store.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

/// Builds what is missing, and says on stderr what was done.
query::IndexReport update_index(store::Store& store, const query::IndexOptions& options,
                                const RunContext& context);

}  // namespace freshet::tools
