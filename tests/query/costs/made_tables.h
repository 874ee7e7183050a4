// tests/query/costs/made_tables.h — tables of a made field, to compare what code for vectors of other widths makes.
#pragma once

#include <vector>

namespace freshet::query {
/// Unary costs, then the tables of all edges.
std::vector<float> made_tables(bool power);
}  // namespace freshet::query
