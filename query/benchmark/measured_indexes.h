// query/benchmark/measured_indexes.h — all indexes that freshet query bench knows.
#pragma once

#include <vector>

#include "query/benchmark/measured_index.h"

namespace freshet::query {

/// In the order of tables and charts. Those of packages that Freshet was built without have no `build`.
std::vector<MeasuredIndex> measured_indexes();

/// Freshet's own that need nothing built before: what it searches by, and every patch's histogram, byte by byte.
MeasuredIndex measured_exact();
MeasuredIndex measured_scan();

}  // namespace freshet::query
