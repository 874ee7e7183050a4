// query/benchmark/measured_indexes.h — all indexes that freshet query bench knows.
#pragma once

#include <vector>

#include "query/benchmark/measured_index.h"

namespace freshet::query {

/// In the order of tables and charts. Those of packages that Freshet was built without have no `build`.
std::vector<MeasuredIndex> measured_indexes();

}  // namespace freshet::query
