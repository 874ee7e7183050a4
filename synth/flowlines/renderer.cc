#include "synth/flowlines/renderer.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {

cv::Mat likeness_of(const std::vector<cv::Mat>& frames, double window_px) {
  const std::size_t half = frames.size() / 2, step = std::max<std::size_t>(1, half / 6);
  const auto detail_of = [](const cv::Mat& frame) {
    cv::Mat grey, detail;
    cv::cvtColor(frame, grey, cv::COLOR_BGR2GRAY);
    cv::Laplacian(grey, detail, CV_32F);
    return detail;
  };
  cv::Mat both(frames.front().size(), CV_32F, cv::Scalar(1e-3)), each = both.clone();
  for (std::size_t t = 0; t < half; t += step) {
    const cv::Mat a = detail_of(frames[t]), b = detail_of(frames[t + half]);
    both += cv::abs(a + b);
    each += cv::abs(a) + cv::abs(b);
  }
  const int side = 2 * static_cast<int>(window_px / 2) + 1;
  cv::blur(both, both, cv::Size(side, side));
  cv::blur(each, each, cv::Size(side, side));
  // Half and half have both / each of their detail, and are given 1 / sqrt(0.5 + 0.5 likeness) of it: see lost_detail.
  cv::Mat left = both / each, likeness = 2 * left.mul(left) - 1;
  return cv::min(cv::max(likeness, 0.0), 1.0);
}

float lost_detail(const Moment& moment, float likeness, Mixing mixing) {
  if (moment.count == 1 || mixing == Mixing::kFeather) return 0;
  float squares = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(moment.count); ++i)
    squares += moment.weight[i] * moment.weight[i];
  // Weights sum to 1: so 1 - squares is what the pairs of unlike frames have.
  return 1 / std::sqrt(squares + likeness * (1 - squares)) - 1;
}

cv::Vec3f mixed(const std::array<cv::Vec3f, 4>& values, const Moment& moment) {
  if (moment.count == 1) return values[0];
  cv::Vec3f sum(0, 0, 0);
  for (std::size_t i = 0; i < static_cast<std::size_t>(moment.count); ++i)
    sum += values[i] * moment.weight[i];
  return sum;
}

void DetailReturn::operator()(cv::Mat& picture, const cv::Mat& mean, const cv::Mat& lost, int side) {
  cv::subtract(picture, mean, difference_, cv::noArray(), CV_16S);
  cv::blur(difference_, around_, cv::Size(side, side));
  tbb::parallel_for(0, picture.rows, [&](int y) {
    auto* to = picture.ptr<cv::Vec3b>(y);
    const auto *here = difference_.ptr<cv::Vec3s>(y), *around = around_.ptr<cv::Vec3s>(y);
    const auto* share = lost.ptr<float>(y);
    for (int x = 0; x < picture.cols; ++x)
      if (share[x] > 0)
        for (int c = 0; c < 3; ++c)
          to[x][c] = cv::saturate_cast<std::uint8_t>(
              static_cast<float>(to[x][c]) + share[x] * static_cast<float>(here[x][c] - around[x][c]));
  });
}

Renderer::Renderer(const std::vector<cv::Mat>& frames, cv::Size working, const RenderOptions& options)
    : frames_(&frames), working_(working), options_(options), lost_(frames.front().size(), CV_32F) {
  if (options_.likeness.empty()) options_.likeness = cv::Mat(frames.front().size(), CV_32F, cv::Scalar(0.5));
  cv::Mat sum(frames.front().size(), CV_32FC3, cv::Scalar::all(0));
  for (const cv::Mat& frame : frames) cv::accumulate(frame, sum);
  sum.convertTo(mean_, CV_8U, 1.0 / static_cast<double>(frames.size()));
}

void Renderer::render(const std::vector<Moment>& moments, cv::Mat& out) {
  out.create(frames_->front().size(), CV_8UC3);
  tbb::parallel_for(0, out.rows, [&](int y) { row(moments, y, out); });
  if (options_.mixing != Mixing::kFeather) return_detail_(out, mean_, lost_, options_.detail_px);
}

void Renderer::row(const std::vector<Moment>& moments, int y, cv::Mat& out) {
  const float down = static_cast<float>(working_.height) / static_cast<float>(out.rows);
  const float along = static_cast<float>(working_.width) / static_cast<float>(out.cols);
  const bool same = working_ == out.size();
  const float wy =
      std::clamp((static_cast<float>(y) + 0.5f) * down - 0.5f, 0.0f, static_cast<float>(working_.height - 1));
  const int y0 = static_cast<int>(wy), y1 = std::min(y0 + 1, working_.height - 1);
  const Moment* top = &moments[static_cast<std::size_t>(y0) * static_cast<std::size_t>(working_.width)];
  const Moment* low = &moments[static_cast<std::size_t>(y1) * static_cast<std::size_t>(working_.width)];
  auto* to = out.ptr<cv::Vec3b>(y);
  auto* lost = lost_.ptr<float>(y);
  const auto* likeness = options_.likeness.ptr<float>(y);
  std::array<cv::Vec3f, 4> values;
  for (int x = 0; x < out.cols; ++x) {
    const float wx = std::clamp((static_cast<float>(x) + 0.5f) * along - 0.5f, 0.0f,
                                static_cast<float>(working_.width - 1));
    const int x0 = static_cast<int>(wx), x1 = std::min(x0 + 1, working_.width - 1);
    const Moment& near =
        (wy - static_cast<float>(y0) < 0.5f ? top : low)[wx - static_cast<float>(x0) < 0.5f ? x0 : x1];
    if (near.count == 1) {
      to[x] = (*frames_)[near.frame[0]].at<cv::Vec3b>(y, x);
      lost[x] = 0;
      continue;
    }
    Moment moment = near;
    if (!same) {
      // Weights lie smoothly between the working picture's pixels, where those speak of the same frames.
      const float fx = wx - static_cast<float>(x0), fy = wy - static_cast<float>(y0);
      const auto of = [&](const Moment& other, std::size_t i) {
        return other.same_frames(near) ? other.weight[i] : near.weight[i];
      };
      for (std::size_t i = 0; i < static_cast<std::size_t>(near.count); ++i)
        moment.weight[i] = (of(top[x0], i) * (1 - fx) + of(top[x1], i) * fx) * (1 - fy) +
                           (of(low[x0], i) * (1 - fx) + of(low[x1], i) * fx) * fy;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(near.count); ++i)
      values[i] = (*frames_)[near.frame[i]].at<cv::Vec3b>(y, x);
    const cv::Vec3f value = mixed(values, moment);
    lost[x] = lost_detail(moment, likeness[x], options_.mixing);
    for (int c = 0; c < 3; ++c) to[x][c] = cv::saturate_cast<std::uint8_t>(value[c]);
  }
}

}  // namespace freshet::synth::flowlines
