#include "synth/flowlines/renderer.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {

cv::Vec3f mixed(const cv::Vec3f& a, const cv::Vec3f& b, float weight, const cv::Vec3f& mean,
                const RenderOptions& options) {
  const float of_a = 1 - weight;
  if (options.mixing == Mixing::kFeather) return a * of_a + b * weight;
  const auto like = static_cast<float>(options.likeness);
  const float gain = 1 / std::sqrt(of_a * of_a + weight * weight + 2 * like * of_a * weight);
  return mean + ((a - mean) * of_a + (b - mean) * weight) * gain;
}

Renderer::Renderer(const std::vector<cv::Mat>& frames, cv::Size working, const RenderOptions& options)
    : frames_(&frames), working_(working), options_(options) {
  mean_ = cv::Mat(frames.front().size(), CV_32FC3, cv::Scalar::all(0));
  for (const cv::Mat& frame : frames) cv::accumulate(frame, mean_);
  mean_ *= 1.0 / static_cast<double>(frames.size());
}

void Renderer::render(const std::vector<Moment>& moments, cv::Mat& out) const {
  out.create(frames_->front().size(), CV_8UC3);
  tbb::parallel_for(0, out.rows, [&](int y) { row(moments, y, out); });
}

void Renderer::row(const std::vector<Moment>& moments, int y, cv::Mat& out) const {
  const float down = static_cast<float>(working_.height) / static_cast<float>(out.rows);
  const float along = static_cast<float>(working_.width) / static_cast<float>(out.cols);
  const bool same = working_ == out.size();
  const float wy =
      std::clamp((static_cast<float>(y) + 0.5f) * down - 0.5f, 0.0f, static_cast<float>(working_.height - 1));
  const int y0 = static_cast<int>(wy), y1 = std::min(y0 + 1, working_.height - 1);
  const Moment* top = &moments[static_cast<std::size_t>(y0) * static_cast<std::size_t>(working_.width)];
  const Moment* low = &moments[static_cast<std::size_t>(y1) * static_cast<std::size_t>(working_.width)];
  auto* to = out.ptr<cv::Vec3b>(y);
  const auto* mean = mean_.ptr<cv::Vec3f>(y);
  for (int x = 0; x < out.cols; ++x) {
    const float wx = std::clamp((static_cast<float>(x) + 0.5f) * along - 0.5f, 0.0f,
                                static_cast<float>(working_.width - 1));
    const int x0 = static_cast<int>(wx), x1 = std::min(x0 + 1, working_.width - 1);
    const Moment& near =
        (wy - static_cast<float>(y0) < 0.5f ? top : low)[wx - static_cast<float>(x0) < 0.5f ? x0 : x1];
    float weight = near.weight;
    if (!same) {
      // Weights lie smoothly between the working picture's pixels, where those speak of the same two frames.
      const float fx = wx - static_cast<float>(x0), fy = wy - static_cast<float>(y0);
      const auto of = [&](const Moment& other) {
        return other.from == near.from && other.to == near.to ? other.weight : near.weight;
      };
      weight = (of(top[x0]) * (1 - fx) + of(top[x1]) * fx) * (1 - fy) +
               (of(low[x0]) * (1 - fx) + of(low[x1]) * fx) * fy;
    }
    if (weight >= 1 || near.from == near.to) {
      to[x] = (*frames_)[near.to].at<cv::Vec3b>(y, x);
    } else if (weight <= 0) {
      to[x] = (*frames_)[near.from].at<cv::Vec3b>(y, x);
    } else {
      const cv::Vec3b a = (*frames_)[near.from].at<cv::Vec3b>(y, x);
      const cv::Vec3b b = (*frames_)[near.to].at<cv::Vec3b>(y, x);
      const cv::Vec3f value = mixed(a, b, weight, mean[x], options_);
      for (int c = 0; c < 3; ++c) to[x][c] = cv::saturate_cast<std::uint8_t>(value[c]);
    }
  }
}

}  // namespace freshet::synth::flowlines
