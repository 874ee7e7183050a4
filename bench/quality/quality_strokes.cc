#include "bench/quality/quality_strokes.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "bench/quality/quality_measures.h"
#include "hints/stroke_field.h"

namespace freshet::bench {
namespace {

constexpr double kMinStrokes = 4, kMaxStrokes = 12;
constexpr float kStep = 4;         // px of a streamline between two readings of the flow
constexpr int kStepsPerPoint = 4;  // a polyline's point every so many
constexpr double kEdge = 16;       // px; nearer to the fluid's end nobody begins a stroke
constexpr double kShortest = 12;   // px; a dot says no direction

/// The motion as seen from some distance: mean over the fluid nearby.
cv::Mat smoothed(const cv::Mat& motion, const cv::Mat& matte, double sigma) {
  cv::Mat full, weight, sum, weights;
  cv::resize(motion, full, matte.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat(matte > 127).convertTo(weight, CV_32F, 1.0 / 255);
  std::vector<cv::Mat> parts;
  cv::split(full, parts);
  cv::GaussianBlur(weight, weights, {}, sigma);
  for (cv::Mat& part : parts) {
    cv::GaussianBlur(part.mul(weight), sum, {}, sigma);
    cv::divide(sum, cv::max(weights, 1e-3), part);
  }
  cv::merge(parts, full);
  return full;
}

class Streamline {
 public:
  Streamline(const cv::Mat& motion, const cv::Mat& matte) : motion_(motion), matte_(matte) {}

  /// Points from `seed` along the motion (sign 1) or against it (-1); without the seed.
  std::vector<cv::Point2f> follow(cv::Point2f seed, float sign, double length) const {
    std::vector<cv::Point2f> points;
    cv::Vec2f before = at(seed);
    for (double gone = 0; gone < length; gone += kStep) {
      const cv::Vec2f now = at(seed);
      const double speed = cv::norm(now);
      if (speed < kMinSpeed || now.dot(before) <= 0) break;
      seed += sign * kStep / static_cast<float>(speed) * cv::Point2f(now[0], now[1]);
      if (!inside(seed)) break;
      points.push_back(seed);
      before = now;
    }
    return points;
  }
  cv::Vec2f at(cv::Point2f p) const { return motion_.at<cv::Vec2f>(cv::Point(p)); }

 private:
  bool inside(cv::Point2f p) const {
    const cv::Point pixel(p);  // rounded: half a pixel before the end it lies beyond it
    return p.x >= 0 && p.y >= 0 && pixel.x < matte_.cols && pixel.y < matte_.rows &&
           matte_.at<std::uint8_t>(pixel) > 127;
  }
  const cv::Mat &motion_, &matte_;
};

double by_fifths(double speed) {
  const double step = std::log(1.2);
  return std::exp(step * std::round(std::log(speed) / step));
}

}  // namespace

std::vector<hints::Stroke> draw_strokes(const cv::Mat& motion, const cv::Mat& matte) {
  const double diagonal = std::hypot(matte.cols, matte.rows), area = cv::countNonZero(matte > 127);
  const cv::Mat smooth = smoothed(motion, matte, diagonal / 80);
  const double fraction = area / static_cast<double>(matte.total());
  const int wanted = static_cast<int>(
      std::lround(kMinStrokes + (kMaxStrokes - kMinStrokes) * std::min(1.0, fraction / 0.75)));
  const Streamline streamline(smooth, matte);

  // The strongest motion first, then what is far from all strokes, the stronger motion rather than the
  // weaker.
  std::vector<cv::Mat> parts;
  cv::split(smooth, parts);
  cv::Mat speed, strength;
  cv::magnitude(parts[0], parts[1], speed);
  cv::pow(speed, 0.25, strength);
  const cv::Mat flowing = (matte > 127) & (speed >= kMinSpeed);
  cv::Mat edge;  // px to what does not flow, the picture's end included
  cv::copyMakeBorder(flowing, edge, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
  cv::distanceTransform(edge, edge, cv::DIST_L2, 3);
  edge = edge(cv::Rect(1, 1, matte.cols, matte.rows));
  const cv::Mat inner = cv::min(edge, kEdge) / kEdge;
  const double apart = 0.4 * std::sqrt(area / wanted);
  cv::Mat drawn(matte.size(), CV_8U, cv::Scalar(255)), distance(matte.size(), CV_32F, cv::Scalar(1));
  std::vector<hints::Stroke> strokes;
  while (static_cast<int>(strokes.size()) < wanted) {
    double best = 0;
    cv::Point seed;
    cv::minMaxLoc(distance.mul(strength).mul(inner), nullptr, &best, nullptr, &seed, flowing);
    if (best <= 0) break;
    const cv::Point2f from(seed);
    std::vector<cv::Point2f> line = streamline.follow(from, -1, diagonal / 16);
    std::reverse(line.begin(), line.end());
    line.push_back(from);
    const std::vector<cv::Point2f> ahead = streamline.follow(from, 1, diagonal / 16);
    line.insert(line.end(), ahead.begin(), ahead.end());
    hints::Stroke stroke;
    double sum = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      sum += cv::norm(streamline.at(line[i]));
      if (i % kStepsPerPoint == 0 || i + 1 == line.size()) stroke.points.push_back(line[i]);
      drawn.at<std::uint8_t>(cv::Point(line[i])) = 0;
    }
    cv::distanceTransform(drawn, distance, cv::DIST_L2, 3);
    cv::threshold(distance, distance, apart, 0, cv::THRESH_TOZERO);
    if (cv::norm(line.back() - line.front()) < kShortest) continue;
    stroke.speed_px_per_s = static_cast<float>(by_fifths(sum / static_cast<double>(line.size())));
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

void guide_by(const std::vector<hints::Stroke>& strokes, cv::Size picture, bool with_speed,
              query::MotionGuide& guide) {
  hints::StrokeField field = hints::interpolate(strokes, picture);
  guide.direction = std::move(field.direction);
  guide.speed = with_speed ? std::move(field.speed) : cv::Mat();
}

}  // namespace freshet::bench
