#include "bench/transfer/transfer_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "report/curve_chart.h"
#include "report/html_text.h"
#include "report/page.h"

namespace freshet::bench {
namespace {

using nlohmann::json;
using report::html_text;

constexpr std::size_t kFramesPerPoint = 5;  // every frame's own mark would make the page a megabyte

struct Measure {
  const char *key, *title, *note;
};
constexpr Measure kMeasures[] = {
    {"sharpness", "sharpness", "Mean squared Laplacian of grey in parts of the exemplar's; 1 is as sharp."},
    {"structure", "structure", "Mean square of what is 4 to 8 px in size, in parts of the exemplar's."},
    {"colours", "colours",
     "L1 distance of the colour histograms from the exemplar's: 0 the same, 2 nothing in common."},
    {"change", "change, levels of 255",
     "Mean difference between a frame and the one before, carried along the flow."},
};

std::string promises(const json& runs) {
  report::HtmlTable table({"exemplar", "design", "px", "method", "frames", "frames not uniform", "violations",
                           "CPU s per frame"});
  for (const json& run : runs) {
    const std::size_t frames = run.at("sharpness").size();
    table.add({html_text(run.at("exemplar").get<std::string>()),
               html_text(run.at("design").get<std::string>()),
               fmt::format("{} x {}", run.at("size").at(0).get<int>(), run.at("size").at(1).get<int>()),
               html_text(run.at("method").get<std::string>()), std::to_string(frames),
               std::to_string(run.at("not_uniform").get<int>()),
               std::to_string(run.at("violations").get<std::int64_t>()),
               fmt::format("{:.2f}", run.at("cpu_s").get<double>() / static_cast<double>(frames))});
  }
  return table.html();
}

report::CurveChart chart_of(const json& runs, const std::string& exemplar, const Measure& measure) {
  report::CurveChart chart{
      .title = "", .x = {"frame"}, .y = {.title = measure.title, .min = 0.0}, .series = {}, .height = 300};
  for (const json& run : runs) {
    if (run.at("exemplar") != exemplar) continue;
    report::ChartSeries series{run.at("method").get<std::string>()};
    const json& values = run.at(measure.key);
    for (std::size_t from = 0; from < values.size(); from += kFramesPerPoint) {
      double sum = 0, count = 0, frames = 0;
      for (std::size_t t = from; t < std::min(from + kFramesPerPoint, values.size()); ++t) {
        if (!values[t].is_number()) continue;
        sum += values[t].get<double>(), frames += static_cast<double>(t), ++count;
      }
      if (count > 0) series.points.push_back({frames / count, sum / count});
    }
    chart.series.push_back(std::move(series));
  }
  return chart;
}

std::string cost_curve(const json& curve) {
  report::CurveChart chart{
      .title = "", .x = {"Mpix", true}, .y = {"CPU s per frame", true}, .series = {}, .height = 380};
  report::HtmlTable table({"Mpix", "CPU s", "wall s", "prepare", "search", "assign", "vote"});
  report::ChartSeries cpu{"CPU, all stages", {}, report::ChartLine::kPower};
  for (const json& point : curve) {
    const double mpix = point.at("mpix").get<double>();
    cpu.points.push_back({mpix, point.at("cpu_s").get<double>()});
    std::vector<std::string> row{fmt::format("{:.2f}", mpix)};
    for (const char* key : {"cpu_s", "wall_s", "prepare_s", "search_s", "assign_s", "vote_s"})
      row.push_back(fmt::format("{:.1f}", point.at(key).get<double>()));
    table.add(row);
  }
  chart.series.push_back(std::move(cpu));
  return report::to_svg(chart) + table.html();
}

}  // namespace

std::string transfer_page(const json& result) {
  const json& runs = result.at("runs");
  std::string out = fmt::format(
      "<p>{}, {} threads, compiler {}. \"uniform\" is the method of Jamriska et al. 2015, \"nearest\" the "
      "retrieval and vote of Kwatra et al. 2005, \"no coherence\" the first with &lambda; = 0. A mark is the "
      "mean of five frames; the JSON file has each.</p>\n",
      html_text(result.at("machine").at("processor").get<std::string>()),
      result.at("machine").at("threads").dump(),
      html_text(result.at("machine").at("compiler").get<std::string>()));
  out +=
      "<h2>What every frame promises</h2>\n<p>Uniform: every source patch of a segment is used K or K + 1 "
      "times. A violation is a target patch of one segment made of a source patch of the other.</p>\n" +
      promises(runs);
  std::vector<std::string> exemplars;
  for (const json& run : runs) {
    const std::string name = run.at("exemplar").get<std::string>();
    if (exemplars.empty() || exemplars.back() != name) exemplars.push_back(name);
  }
  for (const std::string& exemplar : exemplars) {
    out += fmt::format("<h2>{}</h2>\n", html_text(exemplar));
    for (const Measure& measure : kMeasures)
      out += fmt::format("<p>{}</p>\n", measure.note) + report::to_svg(chart_of(runs, exemplar, measure));
  }
  if (!result.at("curve").empty())
    out +=
        "<h2>Cost of a frame</h2>\n<p>All fluid, from a picture 360 px high, default options: the second "
        "frame, "
        "above 1 Mpix the first. Stages in wall clock, on a machine that others used.</p>\n" +
        cost_curve(result.at("curve"));
  return report::page_html("Appearance transfer, frame by frame", out);
}

}  // namespace freshet::bench
