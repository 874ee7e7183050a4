#include "report/curve_chart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "report/html_text.h"

namespace freshet::report {
namespace {

constexpr int kColours = 10;
constexpr std::size_t kMarkers = 8;
constexpr std::array<const char*, kColours> kOnLight{"#1d5fc4", "#c2410c", "#0f7b55", "#9333a8", "#8f6200",
                                                     "#0a7f95", "#c02a68", "#545e6b", "#5f7200", "#7c4a22"};
constexpr std::array<const char*, kColours> kOnDark{"#7fb2ff", "#ff9467", "#5fd3a6", "#d99fe6", "#e6b854",
                                                    "#5ccbdd", "#ff92b8", "#b0b8c3", "#bccb52", "#d0a37e"};

// px: what stands around the plot, the size of text and an upper bound of a letter's width.
constexpr double kLeft = 76, kRight = 150, kTop = 40, kBottom = 58, kText = 13, kLetter = 7.2, kMarker = 4.5;

struct Box {
  double left, top, right, bottom;
  bool meets(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool holds(double x, double y) const { return x > left && x < right && y > top && y < bottom; }
};

// UTF-8: bytes that do not go on with a letter.
double width_of(const std::string& text) {
  return kLetter * static_cast<double>(
                       std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

std::string tick_text(double value) {
  for (const auto& [unit, name] : {std::pair{1e9, " G"}, std::pair{1e6, " M"}, std::pair{1e4, " k"}})
    if (std::abs(value) >= unit) return fmt::format("{:g}{}", value / (unit == 1e4 ? 1e3 : unit), name);
  return fmt::format("{:g}", std::abs(value) < 1e-12 ? 0.0 : value);
}

struct Tick {
  double value;
  bool named;
};

// Values along one axis, and where they lie between 0 and 1.
class Scale {
 public:
  Scale(const ChartAxis& axis, const std::vector<double>& values) : logarithmic_(axis.logarithmic) {
    double minimum = std::numeric_limits<double>::infinity(), maximum = -minimum;
    for (const double value : values) {
      if (!can_show(value)) continue;
      minimum = std::min(minimum, value);
      maximum = std::max(maximum, value);
    }
    if (minimum > maximum) std::tie(minimum, maximum) = std::pair(1.0, 10.0);
    if (axis.min && can_show(*axis.min)) minimum = *axis.min;
    if (axis.max && can_show(*axis.max)) maximum = *axis.max;
    low_ = on_axis(minimum);
    high_ = on_axis(maximum);
    const double room = high_ > low_ ? 0.06 * (high_ - low_) : 0.5;
    if (!axis.min) low_ -= room;
    if (!axis.max || high_ <= low_) high_ += room;
  }
  bool can_show(double value) const { return std::isfinite(value) && (!logarithmic_ || value > 0); }
  double place(double value) const { return (on_axis(value) - low_) / (high_ - low_); }
  double value_at(double place) const {
    const double at = low_ + place * (high_ - low_);
    return logarithmic_ ? std::pow(10.0, at) : at;
  }

  std::vector<Tick> ticks() const { return logarithmic_ ? decades() : steps(); }

 private:
  double on_axis(double value) const { return logarithmic_ ? std::log10(value) : value; }

  std::vector<Tick> steps() const {
    const double rough = (high_ - low_) / 7, power = std::pow(10.0, std::floor(std::log10(rough)));
    double step = 10 * power;
    for (const double nice : {5.0, 2.0, 1.0})
      if (nice * power >= rough) step = nice * power;
    std::vector<Tick> ticks;
    for (double i = std::ceil(low_ / step - 1e-9); i * step <= high_ + 1e-9 * step; ++i)
      ticks.push_back({i * step, true});
    return ticks;
  }

  // Powers of ten; between them 2 and 5, with their names when there are few decades.
  std::vector<Tick> decades() const {
    std::vector<Tick> ticks;
    const int first = static_cast<int>(std::floor(low_)), last = static_cast<int>(std::ceil(high_));
    const int every = std::max(1, (last - first) / 9);
    for (int decade = first; decade <= last; ++decade) {
      for (const int digit : {1, 2, 5}) {
        const double value = std::pow(10.0, decade) * digit, at = on_axis(value);
        if (at < low_ - 1e-9 || at > high_ + 1e-9) continue;
        const bool named = digit == 1 ? (decade - first) % every == 0 : high_ - low_ < 2.6;
        if (named || (digit != 1 && every == 1)) ticks.push_back({value, named});
      }
    }
    return ticks;
  }

  bool logarithmic_;
  double low_ = 0, high_ = 1;
};

std::string marker(std::size_t series, double x, double y) {
  const double r = kMarker;
  const std::size_t shape = (series + series / kColours) % kMarkers;
  const auto polygon = [&](const std::vector<std::pair<double, double>>& corners) {
    std::string points;
    for (const auto& [dx, dy] : corners) points += fmt::format("{:.1f},{:.1f} ", x + dx * r, y + dy * r);
    points.pop_back();
    return fmt::format("<polygon points=\"{}\"", points);
  };
  switch (shape) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\"", x, y, r);
    case 1:
      return polygon({{-.9, -.9}, {.9, -.9}, {.9, .9}, {-.9, .9}});
    case 2:
      return polygon({{0, -1.2}, {1.15, .9}, {-1.15, .9}});
    case 3:
      return polygon({{0, -1.3}, {1.3, 0}, {0, 1.3}, {-1.3, 0}});
    case 4:
      return polygon({{0, 1.2}, {1.15, -.9}, {-1.15, -.9}});
    case 5:  // an upright cross
      return polygon({{-.4, -1.2},
                      {.4, -1.2},
                      {.4, -.4},
                      {1.2, -.4},
                      {1.2, .4},
                      {.4, .4},
                      {.4, 1.2},
                      {-.4, 1.2},
                      {-.4, .4},
                      {-1.2, .4},
                      {-1.2, -.4},
                      {-.4, -.4}});
    case 6:  // a hexagon on its side
      return polygon({{-1.2, 0}, {-.6, -1.05}, {.6, -1.05}, {1.2, 0}, {.6, 1.05}, {-.6, 1.05}});
    default:  // a bar
      return polygon({{-1.4, -.45}, {1.4, -.45}, {1.4, .45}, {-1.4, .45}});
  }
}

class Drawing {
 public:
  explicit Drawing(const CurveChart& chart)
      : chart_(chart),
        plot_{kLeft, kTop, chart.width - kRight, chart.height - kBottom},
        x_(chart.x, all(chart, &ChartPoint::x)),
        y_(chart.y, all(chart, &ChartPoint::y)) {}

  std::string svg() {
    out_ = fmt::format(
        "<svg class=\"chart\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\" "
        "aria-label=\"{2}\" xmlns=\"http://www.w3.org/2000/svg\">\n"
        "<text class=\"title\" x=\"{3}\" y=\"20\">{2}</text>\n",
        chart_.width, chart_.height, html_text(chart_.title), plot_.left);
    axes();
    for (std::size_t s = 0; s < chart_.series.size(); ++s) place(s);
    // What lies beyond the axes is cut off by an element of its own.
    out_ += fmt::format(
        "<svg x=\"{0:.0f}\" y=\"{1:.0f}\" width=\"{2:.0f}\" height=\"{3:.0f}\" "
        "viewBox=\"{0:.0f} {1:.0f} {2:.0f} {3:.0f}\">\n",
        plot_.left, plot_.top, plot_.right - plot_.left, plot_.bottom - plot_.top);
    for (std::size_t s = 0; s < curves_.size(); ++s) line(s);
    out_ += "</svg>\n";
    for (std::size_t s = 0; s < curves_.size(); ++s) markers(s);
    names();
    return out_ + "</svg>\n";
  }

 private:
  struct Curve {
    std::string name;
    std::vector<std::pair<double, double>> line;                                 // px
    std::vector<std::pair<const ChartPoint*, std::pair<double, double>>> marks;  // those inside the plot
  };

  static std::vector<double> all(const CurveChart& chart, double ChartPoint::*value) {
    std::vector<double> values;
    for (const ChartSeries& series : chart.series)
      for (const ChartPoint& point : series.points) values.push_back(point.*value);
    return values;
  }

  double across(double value) const { return plot_.left + x_.place(value) * (plot_.right - plot_.left); }
  double up(double value) const { return plot_.bottom - y_.place(value) * (plot_.bottom - plot_.top); }

  void axes() {
    out_ += "<g class=\"grid\">\n";
    for (const Tick& tick : x_.ticks())
      out_ += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"{3}/>\n",
                          across(tick.value), plot_.top, plot_.bottom, tick.named ? "" : " class=\"minor\"");
    for (const Tick& tick : y_.ticks())
      out_ += fmt::format("<line x1=\"{1:.1f}\" x2=\"{2:.1f}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\"{3}/>\n",
                          up(tick.value), plot_.left, plot_.right, tick.named ? "" : " class=\"minor\"");
    out_ += fmt::format("<path class=\"axis\" d=\"M{0:.1f} {1:.1f}V{2:.1f}H{3:.1f}\"/>\n</g>\n", plot_.left,
                        plot_.top, plot_.bottom, plot_.right);
    for (const Tick& tick : x_.ticks())
      if (tick.named)
        out_ +=
            fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                        across(tick.value), plot_.bottom + 18, tick_text(tick.value));
    for (const Tick& tick : y_.ticks())
      if (tick.named)
        out_ += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                            plot_.left - 8, up(tick.value) + 4, tick_text(tick.value));
    const double middle = (plot_.left + plot_.right) / 2, centre = (plot_.top + plot_.bottom) / 2;
    out_ += fmt::format(
        "<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n"
        "<text class=\"tick\" transform=\"translate(18 {:.1f}) rotate(-90)\" "
        "text-anchor=\"middle\">{}</text>\n",
        middle, plot_.bottom + 38, html_text(chart_.x.title), centre, html_text(chart_.y.title));
  }

  // Turns a series into pixels.
  void place(std::size_t number) {
    const ChartSeries& series = chart_.series[number];
    Curve curve{series.name, {}, {}};
    std::vector<std::pair<double, double>> points;
    for (const ChartPoint& point : series.points) {
      if (!x_.can_show(point.x) || !y_.can_show(point.y)) continue;
      points.emplace_back(across(point.x), up(point.y));
      const auto [x, y] = points.back();
      if (x >= plot_.left - 0.5 && x <= plot_.right + 0.5 && y >= plot_.top - 0.5 && y <= plot_.bottom + 0.5)
        curve.marks.push_back({&point, points.back()});
    }
    const auto fit = series.line == ChartLine::kPower ? fit_power(series.points) : std::optional<PowerFit>();
    if (fit) {
      curve.name = fmt::format("{}: x^{:.2f}", series.name, fit->exponent);
      // Straight on logarithmic axes; on others these are enough for the eye.
      const auto [low, high] = std::minmax_element(points.begin(), points.end());
      constexpr int kPieces = 48;
      for (int i = 0; i <= kPieces; ++i) {
        const double x = low->first + (high->first - low->first) * i / kPieces;
        const double value = x_.value_at((x - plot_.left) / (plot_.right - plot_.left));
        const double fitted = fit->factor * std::pow(value, fit->exponent);
        if (y_.can_show(fitted)) curve.line.emplace_back(x, up(fitted));
      }
    } else if (series.line == ChartLine::kLevel && !points.empty()) {
      curve.line = {{plot_.left, points.back().second}, {plot_.right, points.back().second}};
    } else {
      curve.line = std::move(points);
    }
    curves_.push_back(std::move(curve));
  }

  void line(std::size_t number) {
    const Curve& curve = curves_[number];
    if (curve.line.size() < 2) return;
    std::string points;
    for (const auto& [x, y] : curve.line) points += fmt::format("{:.1f},{:.1f} ", x, y);
    points.pop_back();
    const bool joined = chart_.series[number].line == ChartLine::kThrough;
    out_ += fmt::format("<polyline class=\"s{}\"{} points=\"{}\"/>\n", number % kColours,
                        joined ? "" : " stroke-dasharray=\"6 4\"", points);
  }

  void markers(std::size_t number) {
    for (const auto& [point, at] : curves_[number].marks)
      out_ +=
          fmt::format("{} class=\"s{}\"><title>{}{}{}: {} {:.4g}, {} {:.4g}</title></{}>\n",
                      marker(number, at.first, at.second), number % kColours,
                      html_text(chart_.series[number].name), point->note.empty() ? "" : ", ",
                      html_text(point->note), html_text(chart_.x.title), point->x, html_text(chart_.y.title),
                      point->y, (number + number / kColours) % kMarkers == 0 ? "circle" : "polygon");
  }

  // How much a name at this box would cover: names and the chart's edge weigh most, then markers, then
  // curves.
  double covers(const Box& box, const std::vector<Box>& names) const {
    double cost = 0;
    for (const Box& name : names) cost += box.meets(name) ? 1000 : 0;
    if (box.left < plot_.left + 2 || box.right > chart_.width || box.top < plot_.top - 8 ||
        box.bottom > plot_.bottom + 8)
      cost += 2000;
    for (const Curve& curve : curves_) {
      for (const auto& [point, at] : curve.marks)
        cost += box.meets({at.first - 5, at.second - 5, at.first + 5, at.second + 5}) ? 60 : 0;
      for (std::size_t i = 1; i < curve.line.size(); ++i) {
        const auto [x0, y0] = curve.line[i - 1];
        const auto [x1, y1] = curve.line[i];
        const int steps = std::clamp(static_cast<int>(std::hypot(x1 - x0, y1 - y0) / 4), 1, 400);
        for (int s = 0; s <= steps; ++s) {
          const double x = x0 + (x1 - x0) * s / steps, y = y0 + (y1 - y0) * s / steps;
          if (x <= plot_.right && box.holds(x, y)) cost += 4;
        }
      }
    }
    return cost;
  }

  // Beside the last point where that is free, else beside another, else further off with a thin line to it.
  void names() {
    std::vector<Box> taken;
    std::vector<std::string> missing;
    for (std::size_t s = 0; s < curves_.size(); ++s) {
      const Curve& curve = curves_[s];
      if (curve.marks.empty()) {
        missing.push_back(curve.name);
        continue;
      }
      const double width = width_of(curve.name), height = kText + 2;
      double minimum = std::numeric_limits<double>::infinity();
      Box best{};
      std::pair<double, double> anchor;
      const auto offer = [&](std::pair<double, double> at, double x, double y, double price) {
        const Box box{x, y - height / 2, x + width, y + height / 2};
        const double cost = price + covers(box, taken);
        if (cost < minimum) {
          minimum = cost;
          best = box;
          anchor = at;
        }
      };
      for (std::size_t m = curve.marks.size(); m-- > 0;) {
        const auto at = curve.marks[m].second;
        const double price = m + 1 == curve.marks.size() ? 0 : m == 0 ? 6 : 12;
        offer(at, at.first + 10, at.second, price);
        offer(at, at.first - width / 2, at.second - 15, price + 1);
        offer(at, at.first - width / 2, at.second + 15, price + 1);
        offer(at, at.first - width - 10, at.second, price + 2);
        for (const double far : {24.0, 40.0, 60.0, 85.0, 110.0}) {
          for (const double sign : {-1.0, 1.0}) {
            offer(at, at.first + 14, at.second + sign * far, price + far / 4);
            offer(at, at.first - width - 14, at.second + sign * far, price + far / 4 + 1);
          }
        }
      }
      taken.push_back(best);
      const double y = (best.top + best.bottom) / 2;
      if (std::abs(y - anchor.second) > 18)
        out_ += fmt::format(
            "<line class=\"lead\" x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"/>\n", anchor.first,
            anchor.second, best.left > anchor.first ? best.left - 2 : best.right + 2, y);
      out_ += fmt::format("<text class=\"name s{}\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", s % kColours,
                          best.left, y + 4.5, html_text(curve.name));
    }
    if (!missing.empty())
      out_ += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{}\">Not in this range: {}</text>\n", plot_.left,
                          chart_.height - 4, html_text(fmt::format("{}", fmt::join(missing, ", "))));
  }

  const CurveChart& chart_;
  Box plot_;
  Scale x_, y_;
  std::vector<Curve> curves_;
  std::string out_;
};

}  // namespace

std::string to_svg(const CurveChart& chart) { return Drawing(chart).svg(); }

std::string chart_style() {
  const auto colours = [](const std::array<const char*, kColours>& list) {
    std::string text;
    for (int i = 0; i < kColours; ++i)
      text += fmt::format(" --s{}: {};", i, list[static_cast<std::size_t>(i)]);
    return text;
  };
  std::string style = ":root { --ink: #1a1a1a; --faint: #5c6068; --rule: #dfe2e6; --paper: #ffffff;" +
                      colours(kOnLight) + " }\n" +
                      "@media (prefers-color-scheme: dark) { :root { --ink: #e8e8e8; --faint: #a6abb3; "
                      "--rule: #34383e; --paper: #17191c;" +
                      colours(kOnDark) + " } }\n";
  style +=
      ".chart { max-width: 100%; height: auto; display: block; font: 13px sans-serif; }\n"
      ".chart text { fill: var(--ink); } .chart .title { font-size: 15px; font-weight: bold; }\n"
      ".chart .tick { fill: var(--faint); } .chart .grid line { stroke: var(--rule); }\n"
      ".chart .grid .minor { stroke-dasharray: 1 3; } .chart .axis { stroke: var(--faint); fill: none; }\n"
      ".chart .lead { stroke: var(--faint); stroke-width: .8; }\n"
      ".chart polyline { fill: none; stroke-width: 2; stroke-linejoin: round; }\n"
      ".chart polygon, .chart circle { stroke: var(--paper); stroke-width: 1; }\n"
      ".chart .name { font-weight: bold; paint-order: stroke; stroke: var(--paper); stroke-width: 3px; }\n";
  for (int i = 0; i < kColours; ++i)
    style += fmt::format(
        ".chart polyline.s{0} {{ stroke: var(--s{0}); }} .chart polygon.s{0}, .chart circle.s{0}, "
        ".chart text.s{0} {{ fill: var(--s{0}); }}\n",
        i);
  return style;
}

std::optional<PowerFit> fit_power(const std::vector<ChartPoint>& points) {
  double n = 0, sum_x = 0, sum_y = 0;
  const auto counts = [](const ChartPoint& point) {
    return point.x > 0 && point.y > 0 && std::isfinite(point.x) && std::isfinite(point.y);
  };
  for (const ChartPoint& point : points) {
    if (!counts(point)) continue;
    ++n;
    sum_x += std::log(point.x);
    sum_y += std::log(point.y);
  }
  if (n < 2) return {};
  double xx = 0, xy = 0;
  for (const ChartPoint& point : points) {
    if (!counts(point)) continue;
    const double x = std::log(point.x) - sum_x / n;
    xx += x * x;
    xy += x * (std::log(point.y) - sum_y / n);
  }
  if (xx < 1e-18) return {};
  const double exponent = xy / xx;
  return PowerFit{std::exp((sum_y - exponent * sum_x) / n), exponent};
}

}  // namespace freshet::report
