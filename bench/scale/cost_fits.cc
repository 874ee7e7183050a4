#include "bench/scale/cost_fits.h"

#include <algorithm>
#include <cmath>

namespace freshet::bench {
namespace {

using nlohmann::json;

constexpr double kLarge = 200'000;  // patches, from which fixed costs no longer bend a curve

/// Where a figure lies in a size's JSON, and by what it is multiplied.
struct Figure {
  const char *group, *name, *unit, *where;
  double factor = 1;
};

constexpr double kMega = 1e-6;
constexpr Figure kFigures[] = {
    {"bytes", "file", "MB", "/bytes/file", kMega},
    {"bytes", "columns", "MB", "/bytes/columns", kMega},
    {"bytes", "average images", "MB", "/bytes/average", kMega},
    {"bytes", "frames (5 per clip)", "MB", "/bytes/frames", kMega},
    {"bytes", "flow (4 per clip)", "MB", "/bytes/flow", kMega},
    {"bytes", "indexes", "MB", "/bytes/blobs", kMega},
    {"search", "median", "ms per piece", "/search/median_ms"},
    {"search", "99 of 100", "ms per piece", "/search/p99_ms"},
    {"search", "500 together, per piece", "ms per piece", "/search/batch_s", 2},
    {"open", "cold", "s", "/cold/seconds/total"},
    {"open", "warm", "s", "/warm/seconds/total"},
    {"open", "warm: the store", "s", "/warm/seconds/store"},
    {"open", "warm: columns, index", "s", "/warm/seconds/base"},
    {"open", "warm: search", "s", "/warm/seconds/search"},
    {"memory", "own, searching", "MB", "/search/memory/anonymous", kMega},
    {"memory", "mapped, searching", "MB", "/search/memory/file", kMega},
    {"memory", "peak, searching", "MB", "/search/memory/peak", kMega},
    {"memory", "peak, labelling", "MB", "/label/memory/peak", kMega},
    {"memory", "peak, freshet index", "MB", "/index/memory/peak", kMega},
    {"label", "all", "s", "/label/seconds/total"},
    {"label", "search", "s", "/label/seconds/search"},
    {"label", "costs", "s", "/label/seconds/costs"},
    {"label", "solver", "s", "/label/seconds/minimize"},
    {"whole", "freshet index", "s", "/index/total"},
    {"whole", "store verify", "s", "/keep/verify_s"},
    {"whole", "store info", "s", "/keep/usage_s"},
    {"whole", "made by the bench", "s", "/generate_s"},
};

json at(const json& value, const std::string& where) {
  const json::json_pointer pointer(where);
  return value.contains(pointer) ? value.at(pointer) : json();
}

}  // namespace

std::optional<CostFit> fit_costs(const std::vector<report::ChartPoint>& points, double from) {
  std::vector<std::pair<double, double>> logs;
  for (const report::ChartPoint& point : points) {
    if (point.x >= from && point.x > 0 && point.y > 0)
      logs.emplace_back(std::log(point.x), std::log(point.y));
  }
  const auto n = static_cast<double>(logs.size());
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0, rest = 0;
  for (const auto& [x, y] : logs) {
    mean_x += x / n;
    mean_y += y / n;
  }
  for (const auto& [x, y] : logs) {
    xx += (x - mean_x) * (x - mean_x);
    xy += (x - mean_x) * (y - mean_y);
  }
  if (logs.size() < 2 || !(xx > 0)) return std::nullopt;
  CostFit fit;
  fit.points = logs.size();
  fit.exponent = xy / xx;
  fit.factor = std::exp(mean_y - fit.exponent * mean_x);
  for (const auto& [x, y] : logs) {
    const double off = y - mean_y - fit.exponent * (x - mean_x);
    rest += off * off;
  }
  if (logs.size() > 2) fit.error = std::sqrt(rest / (n - 2) / xx);
  return fit;
}

std::vector<CostCurve> cost_curves(const json& result) {
  std::vector<CostCurve> curves;
  for (const Figure& figure : kFigures) {
    CostCurve curve{figure.group, figure.name, figure.unit, {}};
    for (const json& size : result.at("sizes")) {
      const json value = at(size, figure.where);
      if (value.is_number())
        curve.points.push_back({size.at("patches").get<double>(), value.get<double>() * figure.factor, {}});
    }
    if (!curve.points.empty()) curves.push_back(std::move(curve));
  }
  if (result.contains("ingest")) {
    CostCurve seconds{"ingest", "time", "s", {}}, bytes{"ingest", "store", "MB", {}};
    for (const json& subset : result["ingest"]) {
      seconds.points.push_back({subset.at("patches").get<double>(), subset.at("seconds").get<double>(), {}});
      bytes.points.push_back(
          {subset.at("patches").get<double>(), subset.at("bytes").get<double>() * kMega, {}});
    }
    curves.push_back(std::move(seconds));
    curves.push_back(std::move(bytes));
  }
  return curves;
}

json cost_fits(const json& result) {
  json fits = json::array();
  for (const CostCurve& curve : cost_curves(result)) {
    const auto fit = fit_costs(curve.points);
    if (!fit) continue;
    json line{{"group", curve.group},      {"name", curve.name},  {"unit", curve.unit},
              {"exponent", fit->exponent}, {"error", fit->error}, {"factor", fit->factor},
              {"points", fit->points}};
    if (const auto large = fit_costs(curve.points, kLarge); large && large->points >= 3) {
      line["large_exponent"] = large->exponent;
      line["large_error"] = large->error;
    }
    fits.push_back(std::move(line));
  }
  return fits;
}

}  // namespace freshet::bench
