#include "bench/choices/known_layers.h"

#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "platform/random.h"
#include "synth/simulate/simulate.h"

namespace freshet::bench {
namespace {

constexpr int kFiner = 4;  // supersampling

void branch(cv::Mat& canvas, Random& random, cv::Point2d from, double angle, double length, double width) {
  const cv::Point2d to = from + length * cv::Point2d(std::cos(angle), -std::sin(angle));
  cv::line(canvas, from, to, cv::Scalar(255), std::max(1, cvRound(width)), cv::LINE_AA);
  if (length < 0.018 * canvas.rows) {
    const double leaf = 0.004 * canvas.rows;
    for (int i = 0; i < 4; ++i) {
      const cv::Point2d at = to + cv::Point2d(random.between(-3, 3) * leaf, random.between(-3, 3) * leaf);
      cv::ellipse(canvas, cv::RotatedRect(at, cv::Size2d(2.6 * leaf, 1.2 * leaf), random.between(0, 180)),
                  cv::Scalar(255), cv::FILLED, cv::LINE_AA);
    }
    return;
  }
  const int children = 2 + (random.next() < 0.4f ? 1 : 0);
  for (int i = 0; i < children; ++i)
    branch(canvas, random, to, angle + random.between(-0.7f, 0.7f), length * random.between(0.62f, 0.82f),
           width * 0.62);
}

cv::Mat reduced(const cv::Mat& canvas, cv::Size size) {
  cv::Mat small, alpha;
  cv::resize(canvas, small, size, 0, 0, cv::INTER_AREA);
  small.convertTo(alpha, CV_32F, 1 / 255.0);
  return alpha;
}

}  // namespace

cv::Mat drawn_tree(cv::Size size, std::uint64_t seed) {
  cv::Mat canvas = cv::Mat::zeros(size * kFiner, CV_8U);
  Random random(seed, 1);
  branch(canvas, random, {0.5 * canvas.cols, 0.98 * canvas.rows}, std::numbers::pi / 2, 0.22 * canvas.rows,
         0.028 * canvas.rows);
  cv::Mat alpha = reduced(canvas, size);
  cv::GaussianBlur(alpha, alpha, {}, 0.6);  // as a lens does
  return alpha;
}

cv::Mat drawn_outline(cv::Size size, cv::Point2d middle, double reach, std::uint64_t seed) {
  Random random(seed, 2);
  const double a = random.between(0.05f, 0.2f), b = random.between(0.02f, 0.08f), turn = random.between(0, 6);
  std::vector<cv::Point> curve;
  for (int i = 0; i < 720; ++i) {
    const double t = i * std::numbers::pi / 360;
    const double r = reach * size.height *
                     (1 + a * std::sin(3 * t + turn) + b * std::sin(11 * t) + 0.5 * b * std::sin(29 * t + 1));
    curve.emplace_back(cvRound(kFiner * (middle.x + r * std::cos(t))),
                       cvRound(kFiner * (middle.y + 0.8 * r * std::sin(t))));
  }
  cv::Mat canvas = cv::Mat::zeros(size * kFiner, CV_8U);
  cv::fillPoly(canvas, std::vector<std::vector<cv::Point>>{curve}, cv::Scalar(255), cv::LINE_AA);
  cv::Mat alpha = reduced(canvas, size);
  cv::GaussianBlur(alpha, alpha, {}, 0.8);
  return alpha;
}

cv::Mat simulated_smoke(cv::Size size, std::uint64_t seed) {
  synth::simulate::Simulation clip(
      {.kind = synth::simulate::SceneKind::kSmoke, .size = size, .frames = 1, .seed = seed});
  synth::simulate::SimulatedFrame frame;
  clip.next(frame);
  cv::Mat alpha;
  frame.alpha.convertTo(alpha, CV_32F, 1 / 255.0);
  return alpha;
}

KnownLayers laid_over(const std::string& name, const cv::Mat& front, const cv::Mat& alpha,
                      const cv::Mat& behind, int unsure_px) {
  KnownLayers known{name, {}, alpha.clone(), front.clone(), behind.clone(), {}};
  known.picture.create(alpha.size(), CV_32FC3);
  for (int y = 0; y < alpha.rows; ++y)
    for (int x = 0; x < alpha.cols; ++x) {
      const float a = alpha.at<float>(y, x);
      known.picture.at<cv::Vec3f>(y, x) =
          front.at<cv::Vec3f>(y, x) * a + behind.at<cv::Vec3f>(y, x) * (1 - a);
    }
  cv::Mat bytes;
  known.picture.convertTo(bytes, CV_8U, 255);
  bytes.convertTo(known.picture, CV_32F, 1 / 255.0);
  const cv::Mat element =
      cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * unsure_px + 1, 2 * unsure_px + 1});
  cv::Mat sure_front, sure_behind;
  cv::erode(alpha > 0.99, sure_front, element);
  cv::erode(alpha < 0.005, sure_behind, element);
  known.trimap = cv::Mat(alpha.size(), CV_8U, cv::Scalar(128));
  known.trimap.setTo(255, sure_front);
  known.trimap.setTo(0, sure_behind);
  return known;
}

}  // namespace freshet::bench
