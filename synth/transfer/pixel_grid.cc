#include "synth/transfer/pixel_grid.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "synth/field/portable_math.h"

namespace freshet::synth::transfer {
namespace {

constexpr float kMinAlpha = 1.0f / 4096;

float clamped(float value) { return value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f; }

template <typename Sample>
PixelGrid premultiplied_of(const cv::Mat& bgra, float scale) {
  PixelGrid out(bgra.cols, bgra.rows);
  for_rows(out.height, [&](int y) {
    const Sample* in = bgra.ptr<Sample>(y);
    for (int x = 0; x < out.width; ++x) {
      Pixel& pixel = out(x, y);
      const float alpha = clamped(static_cast<float>(in[4 * x + 3]) * scale);
      for (int c = 0; c < 3; ++c) pixel.c[c] = clamped(static_cast<float>(in[4 * x + c]) * scale) * alpha;
      pixel.c[3] = alpha;
    }
  });
  return out;
}

Pixel mean(const Pixel& a, const Pixel& b, const Pixel& c, const Pixel& d) {
  Pixel out;
  for (int k = 0; k < 4; ++k) out.c[k] = 0.25f * ((a.c[k] + b.c[k]) + (c.c[k] + d.c[k]));
  return out;
}
float mean(float a, float b, float c, float d) { return 0.25f * ((a + b) + (c + d)); }

template <typename T>
GridOf<T> halved_of(const GridOf<T>& grid) {
  GridOf<T> out((grid.width + 1) / 2, (grid.height + 1) / 2);
  for_rows(out.height, [&](int y) {
    const T* a = grid.row(2 * y);
    const T* b = grid.row(std::min(2 * y + 1, grid.height - 1));
    for (int x = 0; x < out.width; ++x) {
      const int left = 2 * x, right = std::min(2 * x + 1, grid.width - 1);
      out(x, y) = mean(a[left], a[right], b[left], b[right]);
    }
  });
  return out;
}

}  // namespace

PixelGrid premultiplied(const cv::Mat& bgra) {
  if (bgra.depth() == CV_8U) return premultiplied_of<std::uint8_t>(bgra, 1.0f / 255);
  if (bgra.depth() == CV_16U) return premultiplied_of<std::uint16_t>(bgra, 1.0f / 65535);
  return premultiplied_of<float>(bgra, 1.0f);
}

cv::Mat straight(const PixelGrid& picture) {
  cv::Mat out(picture.height, picture.width, CV_32FC4);
  for_rows(picture.height, [&](int y) {
    float* to = out.ptr<float>(y);
    for (int x = 0; x < picture.width; ++x) {
      const Pixel& pixel = picture(x, y);
      const bool seen = pixel.c[3] >= kMinAlpha;
      for (int c = 0; c < 3; ++c) to[4 * x + c] = seen ? clamped(pixel.c[c] / pixel.c[3]) : 0.0f;
      to[4 * x + 3] = seen ? clamped(pixel.c[3]) : 0.0f;
    }
  });
  return out;
}

Grid grid_of(const cv::Mat& alpha) {
  Grid out(alpha.cols, alpha.rows);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x)
      out(x, y) = alpha.depth() == CV_8U ? static_cast<float>(alpha.ptr(y)[x]) / 255
                                         : clamped(alpha.ptr<float>(y)[x]);
  return out;
}

VectorGrid vectors_of(const cv::Mat& flow) {
  VectorGrid out(flow.cols, flow.rows);
  for (int y = 0; y < out.height; ++y)
    for (int x = 0; x < out.width; ++x) {
      const cv::Vec2f by = flow.at<cv::Vec2f>(y, x);
      out(x, y) = {by[0], by[1]};
    }
  return out;
}

Grid alpha_of(const PixelGrid& picture) {
  Grid out(picture.width, picture.height);
  for (std::size_t i = 0; i < out.values.size(); ++i) out.values[i] = picture.values[i].c[3];
  return out;
}

PixelGrid halved(const PixelGrid& picture) { return halved_of(picture); }
Grid halved(const Grid& grid) { return halved_of(grid); }

namespace {
// Central differences, one-sided at the edges.
Vec2 slope(const Grid& grid, int x, int y) {
  const int left = std::max(x - 1, 0), right = std::min(x + 1, grid.width - 1), above = std::max(y - 1, 0),
            below = std::min(y + 1, grid.height - 1);
  return {(grid(right, y) - grid(left, y)) / static_cast<float>(std::max(1, right - left)),
          (grid(x, below) - grid(x, above)) / static_cast<float>(std::max(1, below - above))};
}
float within_one(double value) { return static_cast<float>(std::clamp(value, -1.0, 1.0)); }
}  // namespace

Grid curvature(const Grid& blurred_alpha, double scale) {
  // Slopes far below those of an outline have no direction.
  const auto least = static_cast<float>(0.05 / scale);
  Grid across(blurred_alpha.width, blurred_alpha.height), down = across, out = across;
  for_rows(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const Vec2 by = slope(blurred_alpha, x, y);
      const float length = std::sqrt(by.x * by.x + by.y * by.y + least * least);
      across(x, y) = by.x / length;
      down(x, y) = by.y / length;
    }
  });
  for_rows(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x)
      out(x, y) = within_one(-scale * static_cast<double>(slope(across, x, y).x + slope(down, x, y).y));
  });
  return out;
}

Grid divergence(const VectorGrid& flow, const Grid& alpha, double sigma) {
  Grid across(flow.width, flow.height), down = across, out = across, weight = alpha;
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    across.values[i] = alpha.values[i] * flow.values[i].x;
    down.values[i] = alpha.values[i] * flow.values[i].y;
  }
  weight = blurred(weight, sigma), across = blurred(across, sigma), down = blurred(down, sigma);
  for (std::size_t i = 0; i < out.values.size(); ++i) {
    const float by = std::max(weight.values[i], 1e-3f);
    across.values[i] /= by;
    down.values[i] /= by;
  }
  constexpr double kGain = 5;
  for_rows(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x)
      out(x, y) = within_one(kGain * static_cast<double>(slope(across, x, y).x + slope(down, x, y).y));
  });
  return out;
}

Grid blurred(const Grid& grid, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<float> weights(static_cast<std::size_t>(reach) + 1);
  float sum = 0;
  for (int i = 0; i <= reach; ++i) {
    const float at = static_cast<float>(i / sigma);
    weights[static_cast<std::size_t>(i)] = exp_portable(-0.5f * at * at);
    sum += (i == 0 ? 1.0f : 2.0f) * weights[static_cast<std::size_t>(i)];
  }
  for (float& weight : weights) weight /= sum;
  Grid across(grid.width, grid.height), out(grid.width, grid.height);
  for_rows(grid.height, [&](int y) {
    const float* in = grid.row(y);
    for (int x = 0; x < grid.width; ++x) {
      float value = weights[0] * in[x];
      for (int i = 1; i <= reach; ++i)
        value += weights[static_cast<std::size_t>(i)] *
                 (in[std::max(x - i, 0)] + in[std::min(x + i, grid.width - 1)]);
      across(x, y) = value;
    }
  });
  for_rows(grid.height, [&](int y) {
    float* to = out.row(y);
    for (int x = 0; x < grid.width; ++x) to[x] = weights[0] * across(x, y);
    for (int i = 1; i <= reach; ++i) {
      const float* above = across.row(std::max(y - i, 0));
      const float* below = across.row(std::min(y + i, grid.height - 1));
      const float weight = weights[static_cast<std::size_t>(i)];
      for (int x = 0; x < grid.width; ++x) to[x] += weight * (above[x] + below[x]);
    }
  });
  return out;
}

}  // namespace freshet::synth::transfer
