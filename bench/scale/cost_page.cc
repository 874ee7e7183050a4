#include "bench/scale/cost_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/html_text.h"
#include "report/page.h"

namespace freshet::bench {
namespace {

using nlohmann::json;
using report::html_text;

constexpr double kLarge = 200'000;  // patches, from which fixed costs no longer bend a curve

/// A group is a chart. Where a figure lies in a size's JSON, and by what it is multiplied.
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

struct Group {
  const char *key, *title, *note;
};
constexpr Group kGroups[] = {
    {"bytes", "Bytes of a generated store",
     "Frames and flow are those of five frames per clip, not of footage; what footage costs is below."},
    {"ingest", "Ingest of real footage",
     "Subsets of clips that were really ingested, in drawn orders: sums of recorded times and bytes, flow, "
     "frames and all. A clip is ingested by itself, so beyond the last point the line goes on: it is not "
     "measured there, and the time in which the bench makes a store is no ingest."},
    {"search", "Exact search",
     "CPU time of one thread, piece by piece; 500 pieces on all threads, wall clock."},
    {"open", "From nothing to the candidates of one picture",
     "640 x 480 px, all pieces, 100 candidates each, in a new process; cold: the file's pages dropped from "
     "the system's cache before."},
    {"memory", "Memory of a process",
     "Mapped: pages of the store that it has touched; the system may take them back."},
    {"label", "Labelling a picture of 640 x 480 px", "With the index open; 100 candidates per piece."},
    {"whole", "Passes over the whole store",
     "freshet index trains and assigns all words again; the bench's own making is drawn for comparison."},
};

std::string build_of(const json& result) { return result.value("vectors", "wide"); }

json at(const json& value, const std::string& where) {
  const json::json_pointer pointer(where);
  return value.contains(pointer) ? value.at(pointer) : json();
}

std::string number(double value) {
  if (value == 0) return "0";
  const double size = std::abs(value);
  return fmt::format("{:.{}f}", value, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 4);
}

std::string exponent_table(std::span<const json> results) {
  report::HtmlTable table({"cost", "build", "unit", "exponent", "error", "from 200,000 patches", "error"});
  for (const Group& group : kGroups) {
    for (const json& result : results) {
      for (const json& fit : cost_fits(result)) {
        if (fit.at("group") != group.key) continue;
        const auto figure = [&](const char* key) {
          return fit.contains(key) ? fmt::format("{:.2f}", fit[key].get<double>()) : std::string();
        };
        table.add({fmt::format("{}: {}", group.title, html_text(fit.at("name").get<std::string>())),
                   html_text(build_of(result)), html_text(fit.at("unit").get<std::string>()),
                   figure("exponent"), figure("error"), figure("large_exponent"), figure("large_error")});
      }
    }
  }
  return table.html();
}

std::string figure_table(const json& result) {
  std::vector<json> sizes;
  for (const json& size : result.at("sizes")) sizes.push_back(size);
  std::vector<std::string> heads{"patches"}, clips{"clips"};
  for (const json& size : sizes) {
    heads.push_back(at(size, "/patches").dump());
    clips.push_back(std::to_string(size.value("clips", 0)));
  }
  report::HtmlTable table(heads);
  table.add(clips);
  for (const Figure& figure : kFigures) {
    std::vector<std::string> row{
        fmt::format("{}: {}, {}", figure.group, html_text(figure.name), html_text(figure.unit))};
    for (const json& size : sizes) {
      const json value = at(size, figure.where);
      row.push_back(value.is_number() ? number(value.get<double>() * figure.factor) : "");
    }
    if (std::any_of(row.begin() + 1, row.end(), [](const std::string& cell) { return !cell.empty(); }))
      table.add(row);
  }
  return fmt::format("<h2>All figures, {} build</h2>\n", html_text(build_of(result))) + table.html();
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
      const auto note = fmt::format("{} clips", subset.at("clips").get<double>());
      seconds.points.push_back(
          {subset.at("patches").get<double>(), subset.at("seconds").get<double>(), note});
      bytes.points.push_back(
          {subset.at("patches").get<double>(), subset.at("bytes").get<double>() * kMega, note});
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

std::string cost_page(std::span<const json> results) {
  const json& first = results.front();
  std::string out;
  std::string builds;
  for (const json& result : results) builds += (builds.empty() ? "" : ", ") + build_of(result);
  out += fmt::format(
      "<p>Stores of jittered windows of {} real clips ({} patches), made by bench_scaled_store. {}, {} "
      "threads, "
      "g++ {}. Builds: {} (plain: no vectors wider than x86-64 has always had).</p>\n",
      at(first, "/source/clips").dump(), at(first, "/source/patches").dump(),
      html_text(at(first, "/machine/processor").get<std::string>()), at(first, "/machine/threads").dump(),
      html_text(at(first, "/machine/compiler").get<std::string>()), html_text(builds));
  for (const Group& group : kGroups) {
    report::CurveChart chart{"", {"patches", true, {}, {}}, {"", true, {}, {}}, {}};
    for (const json& result : results) {
      for (const CostCurve& curve : cost_curves(result)) {
        if (curve.group != group.key) continue;
        // What a build's vectors have no part in is drawn once.
        const bool again = &result != &first;
        if (again && (curve.group == "bytes" || curve.group == "ingest" || curve.group == "memory")) continue;
        const bool drawn_twice = chart.y.title.find(curve.unit) != std::string::npos;
        if (!drawn_twice) chart.y.title += (chart.y.title.empty() ? "" : ", ") + curve.unit;
        const std::string unit = curve.group == "ingest" ? ", " + curve.unit : "";
        const auto fit = fit_costs(curve.points);
        const std::string exponent = fit ? fmt::format(" x^{:.2f}", fit->exponent) : "";
        chart.series.push_back({curve.name + unit + (again ? " (" + build_of(result) + ")" : "") + exponent,
                                curve.points, report::ChartLine::kThrough});
      }
    }
    if (chart.series.empty()) continue;
    out += fmt::format("<h2>{}</h2>\n<p>{}</p>\n", group.title, group.note) + report::to_svg(chart);
  }
  out +=
      "<h2>Exponents</h2>\n<p>Cost = factor x patches ^ exponent, least squares of logarithms, with the "
      "exponent's standard error.</p>\n" +
      exponent_table(results);
  for (const json& result : results) out += figure_table(result);
  return report::page_html("What a store costs, by its size", out);
}

}  // namespace freshet::bench
