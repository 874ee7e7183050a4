#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "query/mrf/icm.h"
#include "query/mrf/mrf.h"
#include "tests/query/mrf/random_mrf.h"

namespace freshet::query {
namespace {

TEST(Margins, AreWhatTheEnergyRisesByWhenOneLabelIsAnother) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Mrf mrf =
        random_mrf({.width = 4, .height = 3, .labels = 4, .uneven_labels = seed % 2 == 0, .seed = seed});
    Labels labels(mrf.nodes(), 0);
    if (seed % 3 == 0) labels = icm(mrf).labels;
    const std::vector<float> found = margins(mrf, labels);
    ASSERT_EQ(found.size(), mrf.nodes());
    for (std::size_t node = 0; node < mrf.nodes(); ++node) {
      double least = std::numeric_limits<double>::infinity();
      for (std::uint32_t label = 0; label < mrf.label_count[node]; ++label) {
        Labels other = labels;
        other[node] = label;
        if (label != labels[node]) least = std::min(least, energy(mrf, other) - energy(mrf, labels));
      }
      if (std::isinf(least)) {
        EXPECT_EQ(found[node], std::numeric_limits<float>::infinity());
      } else {
        EXPECT_NEAR(found[node], least, 1e-4) << seed << " " << node;
      }
    }
  }
}

TEST(Margins, AreNowhereNegativeInALocalMinimum) {
  const Mrf mrf = picture_sized_mrf(5, 10, 8, 20);
  const std::vector<float> found = margins(mrf, icm(mrf).labels);
  EXPECT_GE(*std::min_element(found.begin(), found.end()), 0);
}

}  // namespace
}  // namespace freshet::query
