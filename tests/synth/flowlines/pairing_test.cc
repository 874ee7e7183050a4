#include "synth/flowlines/pairing.h"

#include <gtest/gtest.h>

#include <limits>

#include <opencv2/core.hpp>

namespace freshet::synth::flowlines {
namespace {

struct Case {
  int lines = 5, inputs = 4;
  std::vector<cv::Mat> error;  // by x
  double of(int x, int before, int y) const {
    return error[static_cast<std::size_t>(x)].at<double>(before, y);
  }
};

Case made_case(std::uint64_t seed) {
  Case made;
  cv::RNG random(seed);
  for (int x = 0; x < made.lines; ++x) {
    made.error.emplace_back(made.inputs, made.inputs, CV_64F);
    random.fill(made.error.back(), cv::RNG::UNIFORM, 0.0, 1.0);
  }
  return made;
}

double total(const Case& made, const std::vector<int>& chosen) {
  double sum = 0;
  for (int x = 1; x < made.lines; ++x)
    sum += made.of(x, chosen[static_cast<std::size_t>(x) - 1], chosen[static_cast<std::size_t>(x)]);
  return sum;
}

double exhaustive(const Case& made, const std::vector<int>& given) {
  double best = std::numeric_limits<double>::max();
  std::vector<int> chosen(static_cast<std::size_t>(made.lines), 0);
  for (;;) {
    bool allowed = true;
    for (std::size_t x = 0; x < given.size(); ++x)
      allowed = allowed && (given[x] < 0 || given[x] == chosen[x]);
    if (allowed) best = std::min(best, total(made, chosen));
    std::size_t x = 0;
    while (x < chosen.size() && ++chosen[x] == made.inputs) chosen[x++] = 0;
    if (x == chosen.size()) return best;
  }
}

TEST(PairLines, IsAsGoodAsExhaustiveSearch) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Case made = made_case(seed);
    const auto error = [&](int x, int before, int y) { return made.of(x, before, y); };
    EXPECT_NEAR(total(made, pair_lines(made.lines, made.inputs, error)), exhaustive(made, {}), 1e-12);
  }
}

TEST(PairLines, KeepsWhatAPersonChose) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Case made = made_case(seed);
    const std::vector<int> given{2, -1, -1, 0, -1};
    const auto error = [&](int x, int before, int y) { return made.of(x, before, y); };
    const std::vector<int> chosen = pair_lines(made.lines, made.inputs, error, given);
    EXPECT_EQ(chosen[0], 2);
    EXPECT_EQ(chosen[3], 0);
    EXPECT_NEAR(total(made, chosen), exhaustive(made, given), 1e-12);
  }
}

}  // namespace
}  // namespace freshet::synth::flowlines
