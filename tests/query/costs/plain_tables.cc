// Writes the bytes of made_tables to stdout: plain_tables [--power]. Built without wide vectors.
#include <cstdio>

#include "tests/query/costs/made_tables.h"

int main(int argc, char**) {
  const std::vector<float> costs = freshet::query::made_tables(argc > 1);
  return std::fwrite(costs.data(), sizeof(float), costs.size(), stdout) == costs.size() ? 0 : 1;
}
