#include "synth/scene/motion/cloud_drift.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <opencv2/imgproc.hpp>

#include "platform/random.h"
#include "synth/scene/wind/weather.h"

namespace freshet::synth::scene {
namespace {

constexpr double kUsual = 0.006;      // of the picture's width, for each m/s
constexpr double kComesRound = 0.75;  // of the layer's width: from there on a loop's clouds go round
constexpr double kWider = 1.25;       // the period, in the layer's widths
constexpr float kFade = 0.35f;        // of the loop, that a place takes to dissolve
constexpr double kComesBack = 0.5;    // px: clouds that a turning wind brings back so near are back
constexpr double kCellShare = 0.02;   // of the longer side: the nodes' distance
constexpr double kSmoothCells = 3;    // sigma of what dissolves together

/// Smooth noise whose values are spread evenly over low..high.
cv::Mat even_noise(cv::Size nodes, std::uint64_t seed, float low, float high) {
  cv::Mat noise(nodes, CV_32F);
  const Random random(seed, 31);
  auto* value = noise.ptr<float>();
  for (std::size_t i = 0; i < noise.total(); ++i) value[i] = random.at(i);
  cv::GaussianBlur(noise, noise, {}, kSmoothCells, kSmoothCells, cv::BORDER_REFLECT);
  std::vector<std::size_t> order(noise.total());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return value[a] < value[b]; });
  cv::Mat even(nodes, CV_32F);
  for (std::size_t i = 0; i < order.size(); ++i)
    even.ptr<float>()[order[i]] =
        low + (high - low) * (static_cast<float>(i) + 0.5f) / static_cast<float>(order.size());
  return even;
}

/// px gone at every frame and at the cycle's end, where the wind changes.
std::vector<double> gone_under(const Weather& weather, const CloudMotion& clouds, int picture_width) {
  const double fastest = std::max(weather.strongest().speed_m_per_s, 1e-9),
               whole_m = weather.steps().back().gone_m;
  std::vector<double> gone{0};
  if (!(whole_m > 0)) return std::vector<double>(1 + weather.steps().size() / Weather::kSteps, 0);
  double along_m = 0;
  for (std::size_t i = 1; i < weather.steps().size(); ++i) {
    const Weather::Step &before = weather.steps()[i - 1], &now = weather.steps()[i];
    const double metres = now.gone_m - before.gone_m;
    along_m += clouds.speed_px_per_s ? metres * *clouds.speed_px_per_s / fastest
                                     : kUsual * picture_width * metres * (before.cosine + now.cosine) / 2;
    if (i % Weather::kSteps == 0) gone.push_back(along_m);
  }
  return gone;
}

/// px, that either copy goes at most; travel   px, from end to end.
double spread(const CloudCourse& course, double travel) {
  for (const double gone : course.gone_px)
    travel = std::max({travel, std::abs(gone), std::abs(gone - course.gone_px.back())});
  return travel;
}

}  // namespace

double CloudCourse::furthest_px(int frames, double fps) const {
  if (gone_px.empty()) return std::abs(speed_px_per_s) * (frames / fps);
  double most = 0;
  for (std::size_t i = 0; i <= std::min(static_cast<std::size_t>(frames), gone_px.size() - 1); ++i)
    most = std::max(most, std::abs(gone_px[i]));
  return most;
}

CloudCourse course_of(const CloudMotion& clouds, const Wind& wind, const Cycle& cycle, bool loop,
                      int width_px, int picture_width) {
  const double along = std::cos(wind.direction_deg * std::numbers::pi / 180);
  CloudCourse course;
  course.speed_px_per_s = clouds.speed_px_per_s.value_or(kUsual * picture_width * wind.speed_m_per_s * along);
  const Weather weather(wind, cycle);
  if (weather.changes()) {
    course.gone_px = gone_under(weather, clouds, picture_width);
    if (loop && std::abs(course.gone_px.back()) < kComesBack) {
      const double left = course.gone_px.back();
      for (std::size_t i = 0; i < course.gone_px.size(); ++i)
        course.gone_px[i] -= left * static_cast<double>(i) / cycle.frames;
      course.gone_px.back() = 0;
    }
    course.speed_px_per_s = course.gone_px.back() / cycle.seconds();
  }
  const double travel = std::abs(course.speed_px_per_s) * cycle.seconds();
  course.period_px = cvCeil(kWider * width_px) + 2;
  if (!loop || travel == 0) return course;
  course.dissolves = travel < kComesRound * width_px || clouds.far_speed != 1;
  if (course.dissolves) {
    // Each copy leaves what is continued beyond one side, and neither comes to what continues the other: where both
    // meet, nothing is seen of it.
    course.period_px = width_px + 2 * std::clamp(cvCeil(spread(course, travel)), width_px / 8, width_px) + 2;
    return course;
  }
  const double rounds = std::max(1.0, std::round(travel / course.period_px));
  course.period_px = std::clamp(cvRound(travel / rounds), cvCeil(1.1 * width_px) + 2, 2 * width_px + 2);
  for (double& gone : course.gone_px) gone *= rounds * course.period_px / travel;
  course.speed_px_per_s = std::copysign(rounds * course.period_px / cycle.seconds(), course.speed_px_per_s);
  return course;
}

std::vector<cv::Point2d> way_over_ground(const CloudMotion& clouds, const Weather& weather,
                                         const Cycle& cycle, int picture_width) {
  std::vector<cv::Point2d> way;
  const Wind wind = weather.at(0);
  const double angle = wind.direction_deg * std::numbers::pi / 180, usual = kUsual * picture_width;
  const cv::Point2d steady(clouds.speed_px_per_s.value_or(usual * wind.speed_m_per_s * std::cos(angle)),
                           usual * wind.speed_m_per_s * std::sin(angle));
  if (!weather.changes())
    for (int i = 0; i <= cycle.frames; ++i) way.push_back(steady * (i / cycle.fps));
  if (!weather.changes()) return way;
  const std::vector<double> along = gone_under(weather, clouds, picture_width);
  double away = 0;
  for (std::size_t i = 0; i < weather.steps().size(); ++i) {
    if (i > 0) {
      const Weather::Step &before = weather.steps()[i - 1], &now = weather.steps()[i];
      away += usual * (now.gone_m - before.gone_m) * (before.sine + now.sine) / 2;
    }
    if (i % Weather::kSteps == 0) way.emplace_back(along[i / Weather::kSteps], away);
  }
  return way;
}

CloudDrift::CloudDrift(const CloudCourse& course, const CloudMotion& clouds, const Cycle& cycle,
                       const cv::Rect& box, std::uint64_t seed)
    : course_(course), cycle_(cycle), box_(box), far_speed_(clouds.far_speed) {
  if (!course.dissolves) return;
  cell_px_ = std::max(2.0, kCellShare * std::max(box.width, box.height));
  const double travel = spread(course, std::abs(course.speed_px_per_s) * cycle.seconds());
  margin_ = static_cast<int>(std::ceil(travel / cell_px_)) + 2;
  const cv::Size nodes(static_cast<int>(box.width / cell_px_) + 2 * margin_ + 2,
                       static_cast<int>(box.height / cell_px_) + 4);
  turns_ = even_noise(nodes, seed, kFade / 2, 1 - kFade / 2);
}

double CloudDrift::speed_at(int y) const {
  const double down = std::clamp((y - box_.y) / std::max(1.0, box_.height - 1.0), 0.0, 1.0);
  return 1 + (far_speed_ - 1) * down;
}

void CloudDrift::go_to(int frame) { go_to_place(cycle_.place(frame)); }
void CloudDrift::go_on_from(int frame) { go_to_place(cycle_.place(frame) + 1); }

void CloudDrift::go_to_place(int place) {
  gone_[0] = course_.gone_at(place, cycle_.fps);
  gone_[1] = course_.gone_px.empty() ? course_.speed_px_per_s * (place - cycle_.frames) / cycle_.fps
                                     : gone_[0] - course_.gone_px.back();
  time_ = static_cast<float>(place) / static_cast<float>(cycle_.frames);
  reach_ = static_cast<float>(std::max(std::abs(gone_[0]), course_.dissolves ? std::abs(gone_[1]) : 0.0)) + 1;
}

void CloudDrift::row(int copy, int, int y, int n, float* dx, float* dy) const {
  std::fill(dx, dx + n, static_cast<float>(-gone_[copy] * speed_at(y)));
  std::fill(dy, dy + n, 0.0f);
}

bool CloudDrift::second(int x, int y, int n, float* part) const {
  if (!course_.dissolves || time_ == 0) return false;
  const double down = std::clamp((y - box_.y) / cell_px_, 0.0, turns_.rows - 1.001);
  const int top = static_cast<int>(down);
  const auto lower = static_cast<float>(down - top);
  const float *above = turns_.ptr<float>(top), *below = turns_.ptr<float>(top + 1);
  const auto from = static_cast<float>((x - box_.x - gone_[0] * speed_at(y)) / cell_px_ + margin_);
  const auto step = static_cast<float>(1 / cell_px_), last = static_cast<float>(turns_.cols) - 1.001f;
  for (int i = 0; i < n; ++i) {
    const float at = std::clamp(from + step * static_cast<float>(i), 0.0f, last);
    const int left = static_cast<int>(at);
    const float right = at - static_cast<float>(left);
    const float a = above[left] + (above[left + 1] - above[left]) * right,
                b = below[left] + (below[left + 1] - below[left]) * right;
    const float t = std::clamp((time_ - (a + (b - a) * lower)) / kFade + 0.5f, 0.0f, 1.0f);
    part[i] = t * t * (3 - 2 * t);
  }
  return true;
}

}  // namespace freshet::synth::scene
