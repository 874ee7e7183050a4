#include "synth/animate/still/base_image.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"

namespace freshet::synth::animate {
namespace {

constexpr double kTapSpacing = 1.5;  // px between samples of the line integral
constexpr int kMaxColours = 3;
constexpr int kRows = 16;            // swept together
constexpr float kMinWeight = 1e-3f;  // below it the picture stays as it is
constexpr double kMinReduced = 2;    // sigma, px of a reduced plane: below it the reduction would show

typedef float Quad __attribute__((vector_size(16)));

/// Three colours times their weight, and the weight, at (x, y), px; beyond the edges they go on.
[[gnu::always_inline]] inline Quad sample(const Quad* plane, std::ptrdiff_t stride, float x, float y,
                                          float right, float bottom) {
  x = std::min(std::max(x, 0.0f), right);
  y = std::min(std::max(y, 0.0f), bottom);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const Quad* a = plane + y0 * stride + x0;
  // At the far edges the part of what lies beyond is zero.
  const int on = fx > 0 ? 1 : 0;
  const Quad* b = fy > 0 ? a + stride : a;
  const Quad upper = a[0] + fx * (a[on] - a[0]), lower = b[0] + fx * (b[on] - b[0]);
  return upper + fy * (lower - upper);
}

/// The line integral along each pixel's motion, one row of it. motion: pairs, px/s.
FRESHET_WIDE void sweep_row(const float* plane, std::ptrdiff_t stride, int columns, int rows, int y,
                            const float* motion, float shutter, float max_length, float* out) {
  const auto* quads = reinterpret_cast<const Quad*>(plane);
  const auto right = static_cast<float>(columns - 1), bottom = static_cast<float>(rows - 1);
  for (int x = 0; x < columns; ++x) {
    const float u = motion[2 * x], v = motion[2 * x + 1], speed = std::sqrt(u * u + v * v);
    const float length = std::min(speed * shutter, max_length);
    const int half = static_cast<int>(length / 2 / static_cast<float>(kTapSpacing)), taps = 2 * half + 1;
    Quad sum = quads[y * stride + x];
    if (half > 0) {
      const float step = length / static_cast<float>(taps - 1) / speed, dx = step * u, dy = step * v;
      for (int i = -half; i <= half; ++i)
        if (i != 0)
          sum += sample(quads, stride, static_cast<float>(x) + static_cast<float>(i) * dx,
                        static_cast<float>(y) + static_cast<float>(i) * dy, right, bottom);
      sum *= 1 / static_cast<float>(taps);
    }
    reinterpret_cast<Quad*>(out)[x] = sum;
  }
}

/// A plane of quads blurred, possibly on a reduced copy.
struct Blurred {
  double sigma = 0;  // px
  cv::Mat values;    // CV_32FC4
};

Quad blurred_at(const Blurred& blurred, cv::Size size, int x, int y) {
  const cv::Mat& values = blurred.values;
  const auto* quads = reinterpret_cast<const Quad*>(values.ptr<float>());
  if (values.size() == size) return quads[static_cast<std::ptrdiff_t>(y) * values.cols + x];
  const auto place = [](int i, int from, int to) {
    return (static_cast<float>(i) + 0.5f) * static_cast<float>(to) / static_cast<float>(from) - 0.5f;
  };
  return sample(quads, values.cols, place(x, size.width, values.cols), place(y, size.height, values.rows),
                static_cast<float>(values.cols - 1), static_cast<float>(values.rows - 1));
}

/// A wide blur shows nothing that half the resolution would not hold.
cv::Mat blur(const cv::Mat& plane, double sigma) {
  int factor = 1;
  while (sigma / (2 * factor) >= kMinReduced) factor *= 2;
  cv::Mat reduced = plane, out;
  double left = sigma;
  if (factor > 1) {
    cv::resize(plane, reduced, {(plane.cols + factor - 1) / factor, (plane.rows + factor - 1) / factor}, 0, 0,
               cv::INTER_AREA);
    // The reduction and the way back blur as well: variances of a box and a tent.
    left = std::sqrt(sigma * sigma - (factor * factor - 1) / 12.0 - factor * factor / 6.0) / factor;
  }
  cv::GaussianBlur(reduced, out, {}, left, left, cv::BORDER_REPLICATE);
  return out;
}

}  // namespace

cv::Mat base_image(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& motion,
                   const BaseImageOptions& options) {
  const int colours = picture.channels();
  CV_Assert(colours <= kMaxColours && picture.depth() == CV_32F);
  cv::Mat out = picture.clone();
  // Where there is fluid, and as far around it as it is blurred.
  cv::Rect fluid = cv::boundingRect(matte > 0);
  if (fluid.empty()) return out;
  const int reach = static_cast<int>(std::ceil(options.max_length_px / 2 + 3 * options.max_sigma_px)) + 2;
  fluid = cv::Rect(fluid.x - reach, fluid.y - reach, fluid.width + 2 * reach, fluid.height + 2 * reach) &
          cv::Rect({}, picture.size());
  const cv::Size size = fluid.size();

  // Colours are carried weighted by the matte, and divided by the weight in the end.
  cv::Mat weighted(size, CV_32FC4, cv::Scalar::all(0)), swept(size, CV_32FC4), sigma(size, CV_32F);
  oneapi::tbb::parallel_for(0, size.height, [&](int y) {
    const float* in = picture.ptr<float>(fluid.y + y) + fluid.x * colours;
    const float* w = matte.ptr<float>(fluid.y + y) + fluid.x;
    float* to = weighted.ptr<float>(y);
    for (int x = 0; x < size.width; ++x) {
      for (int k = 0; k < colours; ++k) to[4 * x + k] = in[x * colours + k] * w[x];
      to[4 * x + 3] = w[x];
    }
  });
  std::vector<double> widest((size.height + kRows - 1) / kRows, 0.0);
  oneapi::tbb::parallel_for(std::size_t{0}, widest.size(), [&](std::size_t band) {
    for (int y = static_cast<int>(band) * kRows;
         y < std::min(size.height, static_cast<int>(band + 1) * kRows); ++y) {
      const cv::Vec2f* velocity = motion.ptr<cv::Vec2f>(fluid.y + y) + fluid.x;
      sweep_row(weighted.ptr<float>(), size.width, size.width, size.height, y,
                reinterpret_cast<const float*>(velocity), static_cast<float>(options.shutter_s),
                static_cast<float>(options.max_length_px), swept.ptr<float>(y));
      for (int x = 0; x < size.width; ++x) {
        const double own =
            std::min(std::hypot(velocity[x][0], velocity[x][1]) * options.gaussian_s, options.max_sigma_px);
        sigma.at<float>(y, x) = static_cast<float>(own);
        widest[band] = std::max(widest[band], own);
      }
    }
  });
  weighted.release();

  // The Gaussian: interpolated between a few fixed widths, as its width changes from pixel to pixel.
  const double maximum = *std::max_element(widest.begin(), widest.end());
  std::vector<Blurred> blurred{{0, swept}};
  for (double next = 1; blurred.size() < 2 || blurred.back().sigma < maximum; next *= 1.6)
    blurred.push_back({next, {}});
  oneapi::tbb::parallel_for(std::size_t{1}, blurred.size(),
                            [&](std::size_t i) { blurred[i].values = blur(swept, blurred[i].sigma); });
  oneapi::tbb::parallel_for(0, size.height, [&](int y) {
    float* to = out.ptr<float>(fluid.y + y) + fluid.x * colours;
    for (int x = 0; x < size.width; ++x) {
      const double own = sigma.at<float>(y, x);
      std::size_t i = 0;
      while (i + 2 < blurred.size() && blurred[i + 1].sigma < own) ++i;
      const float fraction = static_cast<float>(
          std::clamp((own - blurred[i].sigma) / (blurred[i + 1].sigma - blurred[i].sigma), 0.0, 1.0));
      Quad value = blurred_at(blurred[i], size, x, y);
      if (fraction > 0) value += fraction * (blurred_at(blurred[i + 1], size, x, y) - value);
      if (value[3] <= kMinWeight) continue;
      for (int k = 0; k < colours; ++k) to[x * colours + k] = value[k] / value[3];
    }
  });
  return out;
}

}  // namespace freshet::synth::animate
