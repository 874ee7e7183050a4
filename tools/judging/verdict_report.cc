#include "tools/judging/verdict_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "query/labelling/shares.h"

namespace freshet::tools {
namespace {

namespace judging = synth::judging;

nlohmann::json number(double value, double step) {
  return std::isfinite(value) ? nlohmann::json(std::round(value / step) * step) : nlohmann::json();
}

nlohmann::json map_json(const judging::Reading& reading) {
  nlohmann::json spans = nlohmann::json::array();
  for (const cv::Mat& cells : reading.map) {
    nlohmann::json rows = nlohmann::json::array();
    for (int y = 0; y < cells.rows; ++y) {
      nlohmann::json row = nlohmann::json::array();
      for (int x = 0; x < cells.cols; ++x) row.push_back(number(cells.at<float>(y, x), 1e-3));
      rows.push_back(row);
    }
    spans.push_back(rows);
  }
  return spans;
}

}  // namespace

nlohmann::json verdict_json(const judging::Verdict& verdict, const judging::Evidence& film,
                            const std::string& kind) {
  nlohmann::json findings = nlohmann::json::array();
  for (const judging::Finding& finding : verdict.findings) {
    const judging::MeasureWords& words = judging::words_of(finding.measure);
    findings.push_back({{"measure", words.name},
                        {"unit", words.unit},
                        {"value", number(finding.reading.value, 1e-4)},
                        {"usual", number(finding.usual, 1e-4)},
                        {"fault", number(finding.fault, 1e-4)},
                        {"place", judging::place_words(finding, film)},
                        {"map", map_json(finding.reading)}});
  }
  return {{"faults", number(verdict.faults, 1e-4)},
          {"kind", kind},
          {"seconds", verdict.seconds},
          {"words", judging::verdict_words(verdict, film)},
          {"findings", findings}};
}

std::string take_words(const Assumed& assumed, const judging::Verdict& verdict,
                       const judging::Evidence& film) {
  const judging::SpeedRange usual = judging::usual_speed(assumed.kind.name);
  const double side = std::max(film.picture().width, film.picture().height);
  return fmt::format(
      "assumed: {}{}; {}; {:.0f} px/s{}, where {:.0f} to {:.0f} is usual (--speed); {}. Worst: {}",
      assumed.kind.name.empty() ? "any kind" : assumed.kind.name,
      assumed.kind.asked ? ""
      : assumed.kind.seen
          ? assumed.kind.sure ? ", as it looks (--class)" : ", as it may look (--class)"
          : fmt::format(", as {:.0f} % of its patches are (--class)", 100 * assumed.kind.share),
      assumed.direction_asked ? "the direction asked" : "no direction asked (--strokes)",
      verdict.of(judging::Measure::kSpeed).reading.value, assumed.speed_asked ? " as asked" : "",
      usual.slow * side, usual.fast * side,
      assumed.holds ? "what --hold says stands" : "nothing in the matte stands (--hold)",
      judging::verdict_words(verdict, film));
}

}  // namespace freshet::tools
