// report/curve_chart.h — measured curves as a drawing that stands inside a page.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace freshet::report {

struct ChartAxis {
  std::string title;                   // what and in which unit: "recall@100", "ms per piece"
  bool logarithmic = false;            // values at or below 0 are then left out
  std::optional<double> min{}, max{};  // where the axis begins and ends; nothing: round the points
};

struct ChartPoint {
  double x = 0, y = 0;
  std::string note{};  // shown when the pointer rests on it: "ef 200"
};

/// How the points of a series are joined.
enum class ChartLine {
  kThrough,  // from point to point, in the order given
  kLevel,    // across the whole chart at the last point's height: a figure that holds for every x
  kPower,    // the power law that fits them best (fit_power), with its exponent in the label
};

struct ChartSeries {
  std::string name;
  std::vector<ChartPoint> points{};
  ChartLine line = ChartLine::kThrough;
};

struct CurveChart {
  std::string title;
  ChartAxis x, y;
  /// The place in this list decides colour and marker; one may have no points.
  std::vector<ChartSeries> series;
  int width = 880, height = 520;  // px before the page scales it
};

/// An <svg> element, nothing outside itself needed but the colours of chart_style(). Every series has a
/// colour, a marker and its name beside the curve, placed so that names cover neither each other nor, where
/// there is room, a curve. Points beyond an axis are cut off; a series of which nothing is left is named
/// below the chart. Points that are not finite are left out. Beyond 40 series
/// colours and markers together repeat.
std::string to_svg(const CurveChart& chart);

/// Rules for a page's <style>: the colours of all charts in it, for light and dark screens.
std::string chart_style();

/// y = factor * x ^ exponent.
struct PowerFit {
  double factor = 0, exponent = 0;
};
/// Least squares of logarithms over the points whose x and y are above 0; nothing when they have fewer than
/// two different x.
std::optional<PowerFit> fit_power(const std::vector<ChartPoint>& points);

}  // namespace freshet::report
