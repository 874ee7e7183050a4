#include "synth/tour/texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

namespace freshet::synth::tour {
namespace {

constexpr int kRun = 32;                // places that are judged together
constexpr int kMostTaps = 8;            // along the wide side of what a pixel covers
constexpr float kSharp = 1.0f + 1e-4f;  // px that a pixel covers, up to which nothing is averaged

typedef float Quad __attribute__((vector_size(16)));
typedef float UnalignedQuad __attribute__((vector_size(16), aligned(4), may_alias));

Quad quad(const cv::Vec4f& v) { return *reinterpret_cast<const UnalignedQuad*>(v.val); }

/// Catmull-Rom: goes through the samples.
inline Quad cubic_weights(float t) {
  const float t2 = t * t, t3 = t2 * t;
  return Quad{-0.5f * t3 + t2 - 0.5f * t, 1.5f * t3 - 2.5f * t2 + 1, -1.5f * t3 + 2 * t2 + 0.5f * t,
              0.5f * t3 - 0.5f * t2};
}

/// base   the sample (0, 0); stride in samples.
inline Quad cubic(const cv::Vec4f* base, std::ptrdiff_t stride, float x, float y) {
  const float fx = std::floor(x), fy = std::floor(y);
  const Quad wx = cubic_weights(x - fx), wy = cubic_weights(y - fy);
  const cv::Vec4f* at =
      base + (static_cast<std::ptrdiff_t>(fy) - 1) * stride + static_cast<std::ptrdiff_t>(fx) - 1;
  Quad sum{0, 0, 0, 0};
  for (int r = 0; r < 4; ++r, at += stride)
    sum +=
        wy[r] * ((wx[0] * quad(at[0]) + wx[1] * quad(at[1])) + (wx[2] * quad(at[2]) + wx[3] * quad(at[3])));
  return sum;
}

/// To -.5 .. size - .5, mirrored at both edges.
inline float folded(float v, float size) {
  float u = v + 0.5f;
  u = std::abs(u - 2 * size * std::round(u / (2 * size)));
  return std::min(u, size) - 0.5f;
}

void halve(const cv::Mat& from, cv::Mat to) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, to.rows, 32), [&](const auto& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const auto *a = from.ptr<cv::Vec4f>(2 * y),
                 *b = from.ptr<cv::Vec4f>(std::min(2 * y + 1, from.rows - 1));
      auto* out = to.ptr<cv::Vec4f>(y);
      for (int x = 0; x < to.cols; ++x) {
        const int l = 2 * x, r = std::min(2 * x + 1, from.cols - 1);
        const Quad mean = 0.25f * ((quad(a[l]) + quad(a[r])) + (quad(b[l]) + quad(b[r])));
        std::memcpy(out[x].val, &mean, sizeof mean);
      }
    }
  });
}

}  // namespace

Texture::Texture(cv::Size size, Beyond beyond) : size_(size), beyond_(beyond) {
  for (cv::Size level = size;; level = {(level.width + 1) / 2, (level.height + 1) / 2}) {
    levels_.push_back({cv::Mat::zeros(level.height + 2 * kPad, level.width + 2 * kPad, CV_32FC4), level});
    if (std::max(level.width, level.height) <= 4 || levels_.size() == 12) break;
  }
  plane_ = levels_[0].padded({kPad, kPad, size.width, size.height});
}

void Texture::set(const cv::Mat& bgr) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<int>(0, bgr.rows, 32), [&](const auto& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const auto* from = bgr.ptr<cv::Vec3b>(y);
      auto* to = plane_.ptr<cv::Vec4f>(y);
      constexpr float kUnit = 1.0f / 255;
      for (int x = 0; x < bgr.cols; ++x)
        to[x] = {kUnit * static_cast<float>(from[x][0]), kUnit * static_cast<float>(from[x][1]),
                 kUnit * static_cast<float>(from[x][2]), 1};
    }
  });
  filled();
}

void Texture::pad(Level& level) const {
  if (beyond_ == Beyond::kNothing) return;  // it has been 0 from the start
  const int w = level.size.width, h = level.size.height;
  const auto mirrored = [](int i, int n) {
    const int turn = ((i % (2 * n)) + 2 * n) % (2 * n);
    return turn < n ? turn : 2 * n - 1 - turn;
  };
  for (int y = kPad; y < h + kPad; ++y) {
    auto* row = level.padded.ptr<cv::Vec4f>(y) + kPad;
    for (int i = 1; i <= kPad; ++i) {
      row[-i] = row[mirrored(-i, w)];
      row[w - 1 + i] = row[mirrored(w - 1 + i, w)];
    }
  }
  for (int i = 1; i <= kPad; ++i) {
    level.padded.row(kPad + mirrored(-i, h)).copyTo(level.padded.row(kPad - i));
    level.padded.row(kPad + mirrored(h - 1 + i, h)).copyTo(level.padded.row(kPad + h - 1 + i));
  }
}

void Texture::filled() {
  pad(levels_[0]);
  for (std::size_t i = 1; i < levels_.size(); ++i) {
    const Level &from = levels_[i - 1], &to = levels_[i];
    halve(from.padded({kPad, kPad, from.size.width, from.size.height}),
          to.padded({kPad, kPad, to.size.width, to.size.height}));
    pad(levels_[i]);
  }
}

void Texture::average(float x, float y, const float* side, cv::Vec4f& out) const {
  const float along_x = std::sqrt(side[0] * side[0] + side[1] * side[1]),
              along_y = std::sqrt(side[2] * side[2] + side[3] * side[3]);
  const float wide = std::max(along_x, along_y), area = std::abs(side[0] * side[3] - side[1] * side[2]);
  const float* way = along_x >= along_y ? side : side + 2;
  const float narrow = std::max({wide > 0 ? area / wide : 0.0f, wide / kMostTaps, 1.0f});
  // The taps together are as wide as what is covered: each is `narrow` wide itself.
  const float spread = std::max(0.0f, wide - narrow);
  const int taps = std::min(kMostTaps, 1 + static_cast<int>(std::ceil(spread / narrow - 1e-3f)));
  const float step = taps > 1 ? spread / (wide * static_cast<float>(taps - 1)) : 0.0f;
  const float depth = std::min(std::log2(narrow), static_cast<float>(levels_.size() - 1));
  const auto fine = static_cast<std::size_t>(depth);
  const float part = depth - static_cast<float>(fine);
  Quad sum{0, 0, 0, 0};
  for (std::size_t l = fine; l <= fine + (part > 0 ? 1 : 0) && l < levels_.size(); ++l) {
    const Level& level = levels_[l];
    const float scale = 1 / static_cast<float>(1u << l), share = l == fine ? 1 - part : part;
    const auto level_stride = static_cast<std::ptrdiff_t>(level.padded.step1() / 4);
    const auto* level_base = level.padded.ptr<cv::Vec4f>(kPad) + kPad;
    const float last_x = static_cast<float>(level.size.width) + 1,
                last_y = static_cast<float>(level.size.height) + 1;
    Quad of_level{0, 0, 0, 0};
    for (int t = 0; t < taps; ++t) {
      const float away = step * (static_cast<float>(t) - 0.5f * static_cast<float>(taps - 1));
      const float px = (x + away * way[0] + 0.5f) * scale - 0.5f,
                  py = (y + away * way[1] + 0.5f) * scale - 0.5f;
      of_level +=
          cubic(level_base, level_stride, std::clamp(px, -2.0f, last_x), std::clamp(py, -2.0f, last_y));
    }
    sum += of_level * (share / static_cast<float>(taps));
  }
  std::memcpy(out.val, &sum, sizeof sum);
}

void Texture::read(const cv::Matx33d& homography, int x, int y, int n, cv::Vec4f* out) const {
  const double ax = homography(0, 1) * y + homography(0, 2), ay = homography(1, 1) * y + homography(1, 2),
               aw = homography(2, 1) * y + homography(2, 2);
  const auto width = static_cast<float>(size_.width), height = static_cast<float>(size_.height);
  const auto stride = static_cast<std::ptrdiff_t>(levels_[0].padded.step1() / 4);
  const auto* base = levels_[0].padded.ptr<cv::Vec4f>(kPad) + kPad;

  float places_x[kRun], places_y[kRun], inverse[kRun];
  for (int first = 0; first < n; first += kRun) {
    const int count = std::min(kRun, n - first);
    bool outside = false;
    for (int i = 0; i < count; ++i) {
      const double column = x + first + i, w = 1 / (homography(2, 0) * column + aw);
      places_x[i] = static_cast<float>((homography(0, 0) * column + ax) * w);
      places_y[i] = static_cast<float>((homography(1, 0) * column + ay) * w);
      inverse[i] = static_cast<float>(w);
    }
    // What a pixel covers: the sides are its column's and its row's, px of the texture.
    const auto sides = [&](int i, float side[4]) {
      side[0] = (static_cast<float>(homography(0, 0)) - places_x[i] * static_cast<float>(homography(2, 0))) *
                inverse[i];
      side[1] = (static_cast<float>(homography(1, 0)) - places_y[i] * static_cast<float>(homography(2, 0))) *
                inverse[i];
      side[2] = (static_cast<float>(homography(0, 1)) - places_x[i] * static_cast<float>(homography(2, 1))) *
                inverse[i];
      side[3] = (static_cast<float>(homography(1, 1)) - places_y[i] * static_cast<float>(homography(2, 1))) *
                inverse[i];
    };
    const auto shrinks = [&](int i) {
      float s[4];
      sides(i, s);
      return std::max(s[0] * s[0] + s[1] * s[1], s[2] * s[2] + s[3] * s[3]) > kSharp * kSharp;
    };
    // Along a row places go one way, so the ends tell of all.
    for (const int i : {0, count - 1})
      outside = outside || places_x[i] < -0.5f || places_y[i] < -0.5f || places_x[i] > width - 0.5f ||
                places_y[i] > height - 0.5f;
    const bool averaged = shrinks(0) || shrinks(count - 1);
    const auto within = [&](float& px, float& py) {
      if (beyond_ == Beyond::kMirrored) {
        px = folded(px, width);
        py = folded(py, height);
      } else {
        px = std::clamp(px, -2.0f, width + 1);
        py = std::clamp(py, -2.0f, height + 1);
      }
    };
    if (!averaged) {
      for (int i = 0; i < count; ++i) {
        if (outside) within(places_x[i], places_y[i]);
        const Quad value = cubic(base, stride, places_x[i], places_y[i]);
        std::memcpy(out[first + i].val, &value, sizeof value);
      }
      continue;
    }
    for (int i = 0; i < count; ++i) {
      float s[4];
      sides(i, s);
      if (outside) within(places_x[i], places_y[i]);
      average(places_x[i], places_y[i], s, out[first + i]);
    }
  }
}

}  // namespace freshet::synth::tour
