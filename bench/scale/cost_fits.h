// bench/scale/cost_fits.h — costs against the number of patches: curves and their exponents.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/curve_chart.h"

namespace freshet::bench {

/// y = factor * x ^ exponent by least squares of logarithms, and how sure the exponent is.
struct CostFit {
  double factor = 0, exponent = 0;
  double error = 0;  // standard error of the exponent; 0 for two points
  std::size_t points = 0;
};
/// Over points whose x is at least `from`, and whose x and y are above 0. Nothing with fewer than two.
std::optional<CostFit> fit_costs(const std::vector<report::ChartPoint>& points, double from = 0);

/// One cost of one build over all sizes.
struct CostCurve {
  std::string group, name, unit;  // "search", "median", "ms per piece"
  std::vector<report::ChartPoint> points;
};
/// What bench_cost_curves measured, as curves. Sizes that lack a figure have no point.
/// result   one build's JSON: "sizes", and "ingest" where there is one.
std::vector<CostCurve> cost_curves(const nlohmann::json& result);

/// The exponents of all curves, as they go into the JSON: "group", "name", "unit", "exponent", "error",
/// "points"; "large_exponent" and "large_error" over the sizes from 200,000 patches up.
nlohmann::json cost_fits(const nlohmann::json& result);

}  // namespace freshet::bench
