// tools/label_run.h — labelling with its progress and its findings shown on stderr.
#pragma once

#include <string>

#include "query/labelling.h"
#include "tools/run_context.h"
#include "tools/search_options.h"

namespace freshet::tools {

query::Labelling label_with_progress(const store::Snapshot& snapshot, const TargetFiles::Loaded& loaded,
                                     const SearchOptions& search, const LabelOptions& labelling,
                                     const Duration& duration, const RunContext& context);

/// One line: pieces, energy, bound, gap, seconds by stage.
std::string label_summary(const query::Labelling& labelling);

}  // namespace freshet::tools
