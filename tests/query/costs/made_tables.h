// tests/query/costs/made_tables.h — tables of a made field, from code for wide vectors and from the same without.
//
// made_tables.cc and what it calls are compiled twice: as they are, and as freshet_plain, without wide
// vectors.
#pragma once

#include <vector>

namespace freshet::query {
/// Unary costs, then the tables of all edges.
std::vector<float> made_tables(bool power);
}  // namespace freshet::query

namespace freshet_plain::query {
std::vector<float> made_tables(bool power);
}
