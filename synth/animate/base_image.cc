#include "synth/animate/base_image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth {
namespace {

constexpr double kTapSpacing = 1.5;  // px between samples of the line integral
constexpr int kMaxChannels = 4;      // three colours and the weight

/// Bilinear sample of an interleaved float picture, edges repeated.
void sample(const cv::Mat& picture, float x, float y, int channels, float* out) {
  x = std::clamp(x, 0.0f, static_cast<float>(picture.cols - 1));
  y = std::clamp(y, 0.0f, static_cast<float>(picture.rows - 1));
  const int x0 = std::min(static_cast<int>(x), picture.cols - 1),
            y0 = std::min(static_cast<int>(y), picture.rows - 1);
  const int x1 = std::min(x0 + 1, picture.cols - 1), y1 = std::min(y0 + 1, picture.rows - 1);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const float* a = picture.ptr<float>(y0) + x0 * channels;
  const float* b = picture.ptr<float>(y0) + x1 * channels;
  const float* c = picture.ptr<float>(y1) + x0 * channels;
  const float* d = picture.ptr<float>(y1) + x1 * channels;
  for (int k = 0; k < channels; ++k)
    out[k] = (1 - fy) * ((1 - fx) * a[k] + fx * b[k]) + fy * ((1 - fx) * c[k] + fx * d[k]);
}

}  // namespace

cv::Mat base_image(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& motion,
                   const BaseImageOptions& options) {
  const int colours = picture.channels(), channels = colours + 1;
  CV_Assert(channels <= kMaxChannels && picture.depth() == CV_32F);
  // Colours are carried weighted by the matte, and divided by the weight in the end.
  cv::Mat weighted(picture.size(), CV_32FC(channels));
  oneapi::tbb::parallel_for(0, picture.rows, [&](int y) {
    const float* in = picture.ptr<float>(y);
    const float* w = matte.ptr<float>(y);
    float* out = weighted.ptr<float>(y);
    for (int x = 0; x < picture.cols; ++x) {
      for (int k = 0; k < colours; ++k) out[x * channels + k] = in[x * colours + k] * w[x];
      out[x * channels + colours] = w[x];
    }
  });

  // The line integral along each pixel's motion.
  cv::Mat swept(weighted.size(), weighted.type());
  oneapi::tbb::parallel_for(0, picture.rows, [&](int y) {
    std::array<float, kMaxChannels> tap{}, sum{};
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec2f velocity = motion.at<cv::Vec2f>(y, x);
      const double speed = std::hypot(velocity[0], velocity[1]);
      const double length = std::min(speed * options.shutter_s, options.max_length_px);
      const int taps = 2 * static_cast<int>(length / 2 / kTapSpacing) + 1;
      sum.fill(0);
      for (int i = 0; i < taps; ++i) {
        const double along = taps > 1 ? length * (static_cast<double>(i) / (taps - 1) - 0.5) / speed : 0;
        sample(weighted, static_cast<float>(x + velocity[0] * along),
               static_cast<float>(y + velocity[1] * along), channels, tap.data());
        for (int k = 0; k < channels; ++k) sum[k] += tap[k];
      }
      float* out = swept.ptr<float>(y) + x * channels;
      for (int k = 0; k < channels; ++k) out[k] = sum[k] / static_cast<float>(taps);
    }
  });

  // The Gaussian: interpolated between a few fixed widths, as its width changes from pixel to pixel.
  std::vector<double> sigmas{0};
  std::vector<cv::Mat> blurred{swept};
  for (double sigma = 1; sigma < options.max_sigma_px * 1.5; sigma *= 1.6) {
    sigmas.push_back(sigma);
    blurred.emplace_back();
    cv::GaussianBlur(swept, blurred.back(), {}, sigma, sigma, cv::BORDER_REPLICATE);
  }
  cv::Mat out(picture.size(), picture.type());
  oneapi::tbb::parallel_for(0, picture.rows, [&](int y) {
    const float* original = picture.ptr<float>(y);
    float* to = out.ptr<float>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const cv::Vec2f velocity = motion.at<cv::Vec2f>(y, x);
      const double sigma =
          std::min(std::hypot(velocity[0], velocity[1]) * options.gaussian_s, options.max_sigma_px);
      std::size_t i = 0;
      while (i + 2 < sigmas.size() && sigmas[i + 1] < sigma) ++i;
      const float part =
          static_cast<float>(std::clamp((sigma - sigmas[i]) / (sigmas[i + 1] - sigmas[i]), 0.0, 1.0));
      const float* a = blurred[i].ptr<float>(y) + x * channels;
      const float* b = blurred[i + 1].ptr<float>(y) + x * channels;
      const float weight = (1 - part) * a[colours] + part * b[colours];
      for (int k = 0; k < colours; ++k)
        to[x * colours + k] =
            weight > 1e-3f ? ((1 - part) * a[k] + part * b[k]) / weight : original[x * colours + k];
    }
  });
  return out;
}

}  // namespace freshet::synth
