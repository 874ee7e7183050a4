// What the thread sanitizer is to see, and what it is not: a loop whose tasks all write one number, and with --none one
// whose results are read when it has ended.

#include <oneapi/tbb/parallel_for.h>

#include <cstdio>
#include <cstring>
#include <numeric>
#include <vector>

int main(int argc, char** argv) {
  const bool plants = argc < 2 || std::strcmp(argv[1], "--none") != 0;
  std::vector<int> values(1 << 16);
  int all = 0;
  oneapi::tbb::parallel_for(0, static_cast<int>(values.size()), [&](int i) {
    values[static_cast<std::size_t>(i)] = i % 7;
    if (plants) all += i % 7;
  });
  std::printf("%d\n", std::accumulate(values.begin(), values.end(), all));
}
