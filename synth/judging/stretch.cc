#include "synth/judging/stretch.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr double kSmooth = 2;     // px, sigma
constexpr double kMostDrawn = 4;  // octaves
constexpr double kTime = 0.25;    // s, that drawing out is said of

/// Where what lies at each pixel of the run's first frame is after it, CV_32FC2, px.
cv::Mat ends_of(const MotionRun& run) {
  const cv::Size size = run.flow.front().size();
  cv::Mat at(size, CV_32FC2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      at.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
  for (const cv::Mat& flow : run.flow) {
    cv::Mat there;
    cv::remap(flow, there, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    at += there;
  }
  cv::GaussianBlur(at, at, {}, kSmooth);
  return at;
}

/// Octaves that a Jacobian draws out.
double drawn_out(double xx, double xy, double yx, double yy) {
  const double determinant = xx * yy - xy * yx;
  if (determinant <= 0) return kMostDrawn;
  const double squares = xx * xx + xy * xy + yx * yx + yy * yy;  // s1^2 + s2^2, and s1 s2 is the determinant
  const double ratio = squares / (2 * determinant);
  return std::min(kMostDrawn, std::log2(ratio + std::sqrt(std::max(0.0, ratio * ratio - 1))));
}

}  // namespace

Reading stretch(const Evidence& film, const FilmMotion& motion) {
  std::vector<cv::Mat> maps(motion.runs.size());
  std::vector<double> means(motion.runs.size());
  oneapi::tbb::parallel_for(std::size_t{0}, motion.runs.size(), [&](std::size_t i) {
    const MotionRun& run = motion.runs[i];
    const cv::Mat at = ends_of(run);
    const double pace = kTime * film.fps() / static_cast<double>(run.flow.size());
    cv::Mat octaves = cv::Mat::zeros(at.size(), CV_32F);
    for (int y = 1; y + 1 < at.rows; ++y)
      for (int x = 1; x + 1 < at.cols; ++x) {
        const cv::Vec2f dx = (at.at<cv::Vec2f>(y, x + 1) - at.at<cv::Vec2f>(y, x - 1)) / 2;
        const cv::Vec2f dy = (at.at<cv::Vec2f>(y + 1, x) - at.at<cv::Vec2f>(y - 1, x)) / 2;
        octaves.at<float>(y, x) =
            static_cast<float>(std::min(kMostDrawn, pace * drawn_out(dx[0], dy[0], dx[1], dy[1])));
      }
    means[i] = cv::mean(octaves, film.fluid())[0];
    maps[i] = cell_means(octaves, film.matte());
  });
  Reading reading{.value = 0, .map = maps};
  for (double mean : means) reading.value += mean / static_cast<double>(means.size());
  return reading;
}

}  // namespace freshet::synth::judging
