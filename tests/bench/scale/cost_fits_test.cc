#include "bench/scale/cost_fits.h"

#include <gtest/gtest.h>

#include <cmath>

namespace freshet::bench {
namespace {

using nlohmann::json;

json made_result(const std::string& vectors, double exponent) {
  json result{{"machine", {{"processor", "a <processor>"}, {"threads", 2}, {"compiler", "12"}}},
              {"vectors", vectors},
              {"source", {{"clips", 46}, {"patches", 357650}}},
              {"sizes", json::array()}};
  for (const double patches : {1e4, 1e5, 1e6, 2e6, 4e6}) {
    result["sizes"].push_back({{"patches", patches},
                               {"clips", 3},
                               {"bytes", {{"file", 900 * patches}}},
                               {"search", {{"median_ms", 1e-4 * std::pow(patches, exponent)}}}});
  }
  // Only small stores are indexed again.
  result["sizes"][0]["index"]["total"] = 2.0;
  result["sizes"][1]["index"]["total"] = 25.0;
  return result;
}

const json& fit_of(const json& fits, const std::string& name) {
  for (const json& fit : fits) {
    if (fit["name"] == name) return fit;
  }
  throw std::runtime_error("no fit of " + name);
}

TEST(CostFits, FitsAPowerAndSaysHowSurelyIt) {
  std::vector<report::ChartPoint> points;
  for (const double x : {10.0, 100.0, 1000.0, 10000.0}) points.push_back({x, 3 * std::pow(x, 0.7), {}});
  const auto exact = fit_costs(points);
  ASSERT_TRUE(exact);
  EXPECT_NEAR(exact->exponent, 0.7, 1e-12);
  EXPECT_NEAR(exact->factor, 3, 1e-9);
  EXPECT_NEAR(exact->error, 0, 1e-9);
  points[1].y *= 2;
  points[2].y /= 2;
  // Off by +ln 2 and -ln 2 in the middle: slope -2 ln 2 / (10 ln 10), rest and error by hand.
  const auto rough = fit_costs(points);
  const double l = std::log(2.0), step = std::log(10.0);
  EXPECT_NEAR(rough->exponent, 0.7 - l / (5 * step), 1e-12);
  EXPECT_NEAR(rough->error, std::sqrt(1.8 * l * l / 2 / (5 * step * step)), 1e-12);
}

TEST(CostFits, NoFitOfLessThanTwoSizes) {
  EXPECT_FALSE(fit_costs({{10, 1, {}}}));
  EXPECT_FALSE(fit_costs({{10, 1, {}}, {20, 0, {}}})) << "nothing has no logarithm";
  EXPECT_FALSE(fit_costs({{10, 1, {}}, {10, 2, {}}}));
  EXPECT_FALSE(fit_costs({{10, 1, {}}, {1000, 2, {}}}, 100));
}

TEST(CostFits, ExponentsAreThoseOfTheFigures) {
  const json fits = cost_fits(made_result("wide", 1.25));
  EXPECT_NEAR(fit_of(fits, "file")["exponent"].get<double>(), 1, 1e-9);
  EXPECT_NEAR(fit_of(fits, "median")["exponent"].get<double>(), 1.25, 1e-9);
  EXPECT_NEAR(fit_of(fits, "median")["large_exponent"].get<double>(), 1.25, 1e-9);
  EXPECT_EQ(fit_of(fits, "freshet index")["points"], 2);
  EXPECT_FALSE(fit_of(fits, "freshet index").contains("large_exponent"));
}

}  // namespace
}  // namespace freshet::bench
