// tests/query/costs/made_tables.h — tables of a made field, by code for wide vectors and by plain code.
//
// made_tables.cc and what it calls are compiled twice: once without wide vectors, as freshet_plain.
#pragma once

#include <vector>

namespace freshet::query {
/// Unary costs, then the tables of all edges.
std::vector<float> made_tables(bool power);
}  // namespace freshet::query

namespace freshet_plain::query {
std::vector<float> made_tables(bool power);
}
