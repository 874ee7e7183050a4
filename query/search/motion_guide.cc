#include "query/search/motion_guide.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::query {
namespace {

constexpr double kOpening = 1.5;     // of the tolerances, a step
constexpr double kWidestRatio = 16;  // beyond it any speed will do
constexpr double kWindowSteps = 6;   // places of a window's middle within its tolerance

double nearest_step(double value, double step) { return step > 0 ? std::round(value / step) * step : value; }

// Sums over the pixels of one piece.
struct Sums {
  double u = 0, v = 0, log_speed = 0;
  int speeds = 0;

  void add(const MotionGuide& guide, int y, int x) {
    if (!guide.direction.empty()) {
      const cv::Vec2f& way = guide.direction.at<cv::Vec2f>(y, x);
      u += way[0];
      v += way[1];
    }
    if (!guide.speed.empty() && guide.speed.at<float>(y, x) >= 0) {
      // A tenth of a pixel a second stands for standing still, whose logarithm no mean survives.
      log_speed += std::log(std::max(guide.speed.at<float>(y, x), 0.1f));
      ++speeds;
    }
  }
};

}  // namespace

void check_guide(const MotionGuide& guide, cv::Size picture) {
  const auto check_map = [&](const char* what, const cv::Mat& map, int type) {
    if (map.empty() || (map.size() == picture && map.type() == type)) return;
    throw Error(ErrorKind::kUsage, what,
                fmt::format("{} x {} px, and the picture has {} x {}", map.cols, map.rows, picture.width,
                            picture.height),
                "Make it of the picture's size");
  };
  check_map("map of directions", guide.direction, CV_32FC2);
  check_map("map of speeds", guide.speed, CV_32F);
  if (!(guide.tolerance_deg >= 0 && guide.tolerance_deg <= 180))
    throw Error(ErrorKind::kUsage, "direction tolerance",
                fmt::format("{} is out of range, 0 to 180 expected", guide.tolerance_deg));
  if (!(guide.speed_ratio >= 1) || !std::isfinite(guide.speed_ratio))
    throw Error(ErrorKind::kUsage, "speed tolerance",
                fmt::format("{} is out of range, a ratio of at least 1 expected", guide.speed_ratio));
}

HintSearch parse_hint_search(const std::string& name) {
  if (name == "wide") return HintSearch::kWide;
  if (name == "narrow") return HintSearch::kNarrow;
  throw Error(ErrorKind::kUsage, "search with hints \"" + name + "\"", "no such search",
              "Use wide or narrow");
}

MotionGuide widened(MotionGuide guide) {
  guide.tolerance_deg = 180;
  guide.speed_ratio = kWidestRatio;
  return guide;
}

std::vector<PieceMotion> asked_motion(const MotionGuide& guide, const Target& target, const cv::Mat& matte) {
  check_guide(guide, target.picture);
  std::vector<PieceMotion> asked(target.size());
  if (guide.empty()) return asked;
  for (std::size_t piece = 0; piece < target.size(); ++piece) {
    const cv::Rect box =
        cv::Rect(target.corners[piece], cv::Size(target.side, target.side)) & cv::Rect({}, target.picture);
    Sums fluid, all;
    bool any_fluid = false;
    for (int y = box.y; y < box.br().y; ++y)
      for (int x = box.x; x < box.br().x; ++x) {
        all.add(guide, y, x);
        if (matte.at<std::uint8_t>(y, x) <= 127) continue;
        any_fluid = true;
        fluid.add(guide, y, x);
      }
    const Sums& sums = any_fluid ? fluid : all;
    const double length = std::hypot(sums.u, sums.v);
    if (length > 1e-3)
      asked[piece].direction = {static_cast<float>(sums.u / length), static_cast<float>(sums.v / length)};
    if (sums.speeds > 0) asked[piece].speed = static_cast<float>(std::exp(sums.log_speed / sums.speeds));
  }
  return asked;
}

PieceMotion in_steps(const PieceMotion& asked) {
  PieceMotion rounded = asked;
  if (asked.direction != cv::Vec2f(0, 0)) {
    const double angle =
        nearest_step(std::atan2(asked.direction[1], asked.direction[0]), 5 * std::numbers::pi / 180);
    rounded.direction = {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
  }
  if (asked.speed > 0)
    rounded.speed = static_cast<float>(std::exp2(nearest_step(std::log2(asked.speed), 0.1)));
  return rounded;
}

MotionWindow window_of(const PieceMotion& asked, const MotionGuide& guide, int steps) {
  MotionWindow window;
  const double opened = std::pow(kOpening, steps);
  const double angle = std::max(guide.tolerance_deg, steps > 0 ? 1.0 : 0.0) * opened;
  if (asked.direction != cv::Vec2f(0, 0) && angle < 180) {
    const double middle = nearest_step(std::atan2(asked.direction[1], asked.direction[0]),
                                       guide.tolerance_deg * std::numbers::pi / 180 / kWindowSteps);
    window.u = static_cast<float>(std::cos(middle));
    window.v = static_cast<float>(std::sin(middle));
    window.min_cosine = static_cast<float>(std::cos(angle * std::numbers::pi / 180));
    window.min_speed = static_cast<float>(guide.min_speed_px_per_s);
  }
  const double ratio = std::pow(std::max(guide.speed_ratio, steps > 0 ? 1.05 : 1.0), opened);
  if (asked.speed >= 0 && ratio < kWidestRatio) {
    const double middle =
        asked.speed > 0
            ? std::exp(nearest_step(std::log(asked.speed), std::log(guide.speed_ratio) / kWindowSteps))
            : 0;
    window.min_speed = static_cast<float>(middle / ratio);
    // What is asked to stand still may creep.
    window.max_speed = static_cast<float>(std::max(middle * ratio, guide.min_speed_px_per_s));
  }
  return window;
}

}  // namespace freshet::query
