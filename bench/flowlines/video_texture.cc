#include "bench/flowlines/video_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace freshet::bench {
namespace {

/// Distances of frames in their surroundings: i is followed by what j is preceded by.
cv::Mat distances(const std::vector<cv::Mat>& clip, int taps) {
  const int n = static_cast<int>(clip.size());
  cv::Mat plain(n, n, CV_64F, cv::Scalar(0)), out(n, n, CV_64F, cv::Scalar(1e30));
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      plain.at<double>(i, j) = plain.at<double>(j, i) =
          cv::norm(clip[static_cast<std::size_t>(i)], clip[static_cast<std::size_t>(j)], cv::NORM_L2);
  const std::array<double, 4> binomial{1.0 / 8, 3.0 / 8, 3.0 / 8, 1.0 / 8};
  for (int i = taps; i < n - taps; ++i)
    for (int j = taps; j < n - taps; ++j) {
      double sum = 0;
      for (int k = -taps; k < taps; ++k)
        sum +=
            binomial[static_cast<std::size_t>((k + taps) * 4 / (2 * taps))] * plain.at<double>(i + k, j + k);
      out.at<double>(i, j) = sum;
    }
  return out;
}

/// D'' of Sec. 3.3: what a jump costs with all that will follow it.
cv::Mat anticipated(const cv::Mat& distance, double power, double discount) {
  cv::Mat own, future;
  cv::pow(distance, power, own);
  future = own.clone();
  for (int round = 0; round < 200; ++round)
    for (int i = distance.rows - 1; i >= 0; --i)
      for (int j = 0; j < distance.cols; ++j) {
        double least = 0;
        if (j + 1 < distance.rows)
          cv::minMaxLoc(future.row(j), &least);
        else
          least = 1e30;
        future.at<double>(i, j) = own.at<double>(i, j) + discount * std::min(least, 1e30);
      }
  return future;
}

}  // namespace

std::vector<cv::Mat> fading_loop(const std::vector<cv::Mat>& clip, int fade, int frames) {
  const int period = static_cast<int>(clip.size()) - fade;
  std::vector<cv::Mat> out;
  for (int t = 0; t < frames; ++t) {
    const int at = t % period;
    if (at >= fade || t < period) {
      out.push_back(clip[static_cast<std::size_t>(at)].clone());
      continue;
    }
    const double share = (at + 1.0) / (fade + 1.0);
    cv::Mat mixed;
    cv::addWeighted(clip[static_cast<std::size_t>(at)], share, clip[static_cast<std::size_t>(at + period)],
                    1 - share, 0, mixed);
    out.push_back(mixed);
  }
  return out;
}

std::vector<cv::Mat> video_texture(const std::vector<cv::Mat>& clip, int frames,
                                   const VideoTextureOptions& options) {
  const int n = static_cast<int>(clip.size());
  const cv::Mat distance = distances(clip, options.taps);
  // Entry (i, j) is the cost of showing j after i: what i + 1 and j differ by.
  cv::Mat jump(n - 1, n, CV_64F);
  for (int i = 0; i + 1 < n; ++i) distance.row(i + 1).copyTo(jump.row(i));
  const cv::Mat future = anticipated(jump, options.power, options.discount);
  double sum = 0;
  int count = 0;
  for (int i = 0; i < jump.rows; ++i)
    for (int j = 0; j < n; ++j)
      if (jump.at<double>(i, j) < 1e29 && jump.at<double>(i, j) > 0) {
        sum += std::pow(jump.at<double>(i, j), options.power);
        ++count;
      }
  const double sigma = options.sharpness * sum / std::max(1, count);
  std::mt19937_64 random(options.seed);
  std::vector<cv::Mat> out;
  int at = options.taps;
  for (int t = 0; t < frames; ++t) {
    out.push_back(clip[static_cast<std::size_t>(at)]);
    const int from = std::min(at, jump.rows - 1);
    double least = 0;
    cv::minMaxLoc(future.row(from), &least);
    std::vector<double> weight(static_cast<std::size_t>(n));
    for (int j = 0; j < n; ++j)
      weight[static_cast<std::size_t>(j)] = std::exp(-(future.at<double>(from, j) - least) / sigma);
    std::discrete_distribution<int> choose(weight.begin(), weight.end());
    at = choose(random);
  }
  return out;
}

}  // namespace freshet::bench
