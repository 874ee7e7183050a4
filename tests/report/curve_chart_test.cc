#include "report/curve_chart.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <pugixml.hpp>
#include <set>
#include <string>

namespace freshet::report {
namespace {

CurveChart some_chart() {
  return {.title = "Time & recall",
          .x = {.title = "recall@100"},
          .y = {.title = "ms per piece", .logarithmic = true},
          .series = {{"exact", {{1, 0.5, "none"}}, ChartLine::kLevel},
                     {"<peer>", {{0.4, 0.1}, {0.9, 1}, {0.99, 10}}}}};
}

pugi::xml_document parsed(const std::string& svg) {
  pugi::xml_document document;
  const auto result = document.load_string(svg.c_str());
  EXPECT_TRUE(result) << result.description() << "\n" << svg;
  return document;
}

std::vector<pugi::xml_node> found(const pugi::xml_document& document, const std::string& path) {
  std::vector<pugi::xml_node> nodes;
  for (const auto& node : document.select_nodes(path.c_str())) nodes.push_back(node.node());
  return nodes;
}

TEST(CurveChart, IsWellFormedAndNamesItsSeriesAndAxes) {
  const auto svg = parsed(to_svg(some_chart()));
  std::set<std::string> texts;
  for (const auto& text : found(svg, "//text")) texts.insert(text.text().get());
  for (const char* expected : {"Time & recall", "recall@100", "ms per piece", "exact", "<peer>"})
    EXPECT_TRUE(texts.contains(expected)) << expected;
}

TEST(CurveChart, APlaceOnALogarithmicAxisGoesByRatios) {
  const auto svg = parsed(to_svg(some_chart()));
  const auto marks = found(svg, "//polygon[@class='s1']");
  ASSERT_EQ(marks.size(), 3U);
  const auto y = [&](std::size_t i) {
    const std::string points = marks[i].attribute("points").value();  // a square's first corner
    return std::stod(points.substr(points.find(',') + 1));
  };
  EXPECT_NEAR(y(0) - y(1), y(1) - y(2), 0.3);
  EXPECT_GT(y(0) - y(1), 50);
}

TEST(CurveChart, LeavesOutWhatCannotBeShownAndSaysWhoIsNotInRange) {
  CurveChart chart = some_chart();
  chart.x.min = 0.95;
  chart.series[1].points = {{0.2, 1}, {0.5, 2}};
  chart.series.push_back({"odd", {{0.97, 0}, {0.98, std::nan("")}, {0.99, -1}}});
  const auto svg = parsed(to_svg(chart));
  EXPECT_EQ(found(svg, "//polygon").size(), 0U);
  const auto texts = found(svg, "//text");
  EXPECT_STREQ(texts.back().text().get(), "Not in this range: <peer>, odd");
  EXPECT_EQ(to_svg(chart).find("nan"), std::string::npos);
  EXPECT_EQ(to_svg(chart).find("inf"), std::string::npos);
}

TEST(CurveChart, NamesDoNotCoverEachOther) {
  CurveChart chart = some_chart();
  chart.series.clear();
  for (int i = 0; i < 8; ++i)
    chart.series.push_back({"a rather long name " + std::to_string(i), {{0.5, 1}, {0.9, 2 + 0.05 * i}}});
  const auto svg = parsed(to_svg(chart));
  struct Place {
    double x, y;
  };
  std::vector<Place> places;
  for (const auto& name : found(svg, "//text[starts-with(@class, 'name')]"))
    places.push_back({name.attribute("x").as_double(), name.attribute("y").as_double()});
  ASSERT_EQ(places.size(), 8U);
  for (std::size_t a = 0; a < places.size(); ++a)
    for (std::size_t b = 0; b < a; ++b)
      EXPECT_TRUE(std::abs(places[a].y - places[b].y) >= 14 || std::abs(places[a].x - places[b].x) >= 130)
          << a << " and " << b;
}

TEST(CurveChart, TicksAreNamedInRoundNumbers) {
  CurveChart chart;
  chart.x = {.title = "patches", .logarithmic = true, .min = 1e4, .max = 5e6};
  chart.y = {.title = "s", .min = 0, .max = 1};
  chart.series = {{"a", {{1e4, 0.1}, {5e6, 0.9}}}};
  std::set<std::string> texts;
  const auto svg = parsed(to_svg(chart));
  for (const auto& text : found(svg, "//text[@class='tick']")) texts.insert(text.text().get());
  for (const char* expected : {"10 k", "100 k", "1 M", "0", "0.2", "1"})
    EXPECT_TRUE(texts.contains(expected)) << expected;
}

TEST(CurveChart, FitsAPowerLawAndSaysItsExponent) {
  ChartSeries series{"bytes", {}, ChartLine::kPower};
  for (const double x : {1e4, 1e5, 1e6}) series.points.push_back({x, 3 * std::pow(x, 0.75)});
  const auto fit = fit_power(series.points);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->exponent, 0.75, 1e-9);
  EXPECT_NEAR(fit->factor, 3, 1e-6);
  EXPECT_FALSE(fit_power({{1, 2}}));
  EXPECT_FALSE(fit_power({{5, 2}, {5, 3}}));
  EXPECT_FALSE(fit_power({{5, 2}, {-5, 3}, {6, 0}}));
  CurveChart chart{.title = "t",
                   .x = {.title = "x", .logarithmic = true},
                   .y = {.title = "y", .logarithmic = true},
                   .series = {series}};
  EXPECT_NE(to_svg(chart).find(">bytes: x^0.75<"), std::string::npos);
}

TEST(CurveChart, IsDrawnEvenOfNothing) {
  EXPECT_EQ(to_svg({}).find("nan"), std::string::npos);
  CurveChart chart = some_chart();
  chart.series = {{"one", {{0.5, 2}}, ChartLine::kPower}};
  parsed(to_svg(chart));
}

TEST(CurveChart, HasAColourForEverySeriesOnLightAndDark) {
  const std::string style = chart_style();
  EXPECT_NE(style.find("prefers-color-scheme: dark"), std::string::npos);
  for (int i = 0; i < 10; ++i)
    EXPECT_NE(style.find("polyline.s" + std::to_string(i) + " {"), std::string::npos);
}

}  // namespace
}  // namespace freshet::report
