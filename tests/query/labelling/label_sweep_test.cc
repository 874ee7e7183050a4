#include "query/labelling/label_sweep.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <atomic>
#include <cmath>

#include "freshet/error.h"
#include "query/index/index_builder.h"
#include "tests/query/made_store.h"

namespace freshet::query {
namespace {

class Sweep : public testing::Test {
 protected:
  Sweep() {
    store::Store store = made_store(folder_.path() / "a.store", some_clips());
    build_index(store);
    snapshot_ = std::make_unique<store::Snapshot>(store.snapshot());
    base_ = open_search(*snapshot_);
    cv::cvtColor(made_texture(1), picture_, cv::COLOR_GRAY2BGR);
    matte_ = cv::Mat(picture_.size(), CV_8U, cv::Scalar(255));
    options_.candidates.k = 15;
    options_.guide.direction = cv::Mat(picture_.size(), CV_32FC2, cv::Scalar(0.6, 0.8));
    search_ = search_candidates(*snapshot_, base_, picture_, matte_, options_);
    for (const double sigma : {0.0, 0.125, 2.0})
      for (const double rho : {0.25, 4.0}) variations_.push_back({.costs = {.sigma = sigma, .rho = rho}});
    variations_.push_back({.costs = default_costs(CostForm::kPower)});
    variations_.push_back({.costs = {.lambda = 0}});
    variations_.push_back({.costs = {.vote = 0}, .minimizer = Minimizer::kAlphaExpansion});
    variations_.push_back({.max_iterations = 2});
  }
  void expect_as_alone(const std::vector<SweptLabelling>& swept) const {
    ASSERT_EQ(swept.size(), variations_.size());
    for (std::size_t i = 0; i < swept.size(); ++i) {
      LabelOptions options = options_;
      options.costs = variations_[i].costs;
      options.minimizer = variations_[i].minimizer;
      options.max_iterations = variations_[i].max_iterations;
      const Labelling alone = label(*snapshot_, base_, picture_, matte_, options);
      EXPECT_EQ(swept[i].labels, alone.labels) << i;
      EXPECT_EQ(swept[i].assignment, alone.assignment) << i;
      EXPECT_EQ(swept[i].iterations, alone.iterations) << i;
    }
  }

  const ScratchFolder folder_;
  std::unique_ptr<store::Snapshot> snapshot_;
  SearchBase base_;
  cv::Mat picture_, matte_;
  LabelOptions options_;
  CandidateSearch search_;
  std::vector<LabelVariation> variations_;
};

TEST_F(Sweep, EachLabellingIsThatOfItsOptionsAlone) {
  std::atomic<std::size_t> maximum = 0, calls = 0;
  expect_as_alone(label_variations(*snapshot_, search_, variations_, {}, [&](std::size_t done) {
    ++calls;
    for (std::size_t seen = maximum; done > seen && !maximum.compare_exchange_weak(seen, done);) {
    }
  }));
  EXPECT_EQ(calls, variations_.size());
  EXPECT_EQ(maximum, variations_.size());
}

TEST_F(Sweep, NeitherMemoryNorThreadsChangeIt) {
  expect_as_alone(label_variations(*snapshot_, search_, variations_, {.memory_bytes = 1000}));
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  expect_as_alone(label_variations(*snapshot_, search_, variations_));
}

TEST_F(Sweep, RefusesWeightsBeforeItBegins) {
  variations_.back().costs.rho = std::nan("");
  EXPECT_THROW(
      label_variations(*snapshot_, search_, variations_, {}, [](std::size_t) { ADD_FAILURE() << "began"; }),
      Error);
}

TEST_F(Sweep, StopsWhenAsked) {
  std::stop_source source;
  source.request_stop();
  try {
    label_variations(*snapshot_, search_, variations_, {}, {}, source.get_token());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kCancelled);
  }
}

}  // namespace
}  // namespace freshet::query
