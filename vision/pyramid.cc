#include "vision/pyramid.h"

#include <algorithm>
#include <array>
#include <cstddef>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/vectors.h"

namespace freshet::vision {
namespace {

// Planes of one channel, as cv::pyrDown and cv::pyrUp of OpenCV 4.6 on x86-64 make them, to the bit, for wide vectors
// and without a plane between a level and its band: theirs know 16 bytes. Sums of fours of columns are added up in
// another order there than what remains.
constexpr int kFours = 4;

int fours(int n) { return n / kFours * kFours; }

FRESHET_WIDE void reduce_fours(const float* from, int n, float* to) {
  for (int i = 0; i < n; ++i)
    to[i] = from[2 * i + 2] * 6 + ((from[2 * i + 1] + from[2 * i + 3]) * 4 + (from[2 * i] + from[2 * i + 4]));
}

float reduced(float before2, float before, float middle, float after, float after2) {
  return middle * 6 + (before + after) * 4 + before2 + after2;
}

/// A row of n samples to half as many, rounded up; n > 4.
void reduce_row(const float* from, int n, float* to) {
  const int half = (n + 1) / 2, inner = (n - 3) / 2 + 1;  // whose five samples are all there: [1, inner)
  to[0] = reduced(from[2], from[1], from[0], from[1], from[2]);
  const int vectors = fours(inner - 1);
  reduce_fours(from, vectors, to + 1);
  for (int i = 1 + vectors; i < inner; ++i)
    to[i] = reduced(from[2 * i - 2], from[2 * i - 1], from[2 * i], from[2 * i + 1], from[2 * i + 2]);
  const auto mirrored = [from, n](int x) { return from[x < n ? x : 2 * n - 2 - x]; };
  for (int i = inner; i < half; ++i)
    to[i] = reduced(from[2 * i - 2], from[2 * i - 1], from[2 * i], mirrored(2 * i + 1), mirrored(2 * i + 2));
}

FRESHET_WIDE void reduce_rows(const std::array<const float*, 5>& rows, int n, float* to) {
  const float *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3], *e = rows[4];
  const int vectors = n / kFours * kFours;
  for (int i = 0; i < vectors; ++i)
    to[i] = ((b[i] + d[i] + c[i]) * 4 + (a[i] + e[i] + (c[i] + c[i]))) * (1.0f / 256);
  for (int i = vectors; i < n; ++i) to[i] = (c[i] * 6 + (b[i] + d[i]) * 4 + a[i] + e[i]) * (1.0f / 256);
}

void reduce(const cv::Mat& from, cv::Mat& to) {
  const int half = (from.cols + 1) / 2;
  to.create((from.rows + 1) / 2, half, CV_32F);
  std::vector<float> ring(static_cast<std::size_t>(half) * 5);
  const auto line = [&](int y) { return ring.data() + static_cast<std::ptrdiff_t>(half) * ((y + 5) % 5); };
  for (int y = 0, next = -2; y < to.rows; ++y) {
    for (; next <= 2 * y + 2; ++next) {
      const int row = next < 0 ? -next : next < from.rows ? next : 2 * from.rows - 2 - next;
      reduce_row(from.ptr<float>(row), from.cols, line(next));
    }
    reduce_rows({line(2 * y - 2), line(2 * y - 1), line(2 * y), line(2 * y + 1), line(2 * y + 2)}, half,
                to.ptr<float>(y));
  }
}

FRESHET_WIDE void widen_inner(const float* from, int n, float* to) {
  for (int i = 0; i < n; ++i) {
    to[2 * i] = from[i] + from[i + 1] * 6 + from[i + 2];
    to[2 * i + 1] = (from[i + 1] + from[i + 2]) * 4;
  }
}

/// A row of n samples to twice as many; n > 1.
void widen_row(const float* from, int n, float* to) {
  to[0] = from[0] * 6 + from[1] * 2;
  to[1] = (from[0] + from[1]) * 4;
  widen_inner(from, n - 2, to + 2);
  to[2 * n - 2] = from[n - 2] + from[n - 1] * 7;
  to[2 * n - 1] = from[n - 1] * 8;
}

// Rows a, b, c of which b lies at the even row.
[[gnu::always_inline]] inline float even_row(float a, float b, float c) {
  return (6 * b + a + c) * (1.0f / 64);
}
[[gnu::always_inline]] inline float odd_row(float b, float c) { return (b + c) * (1.0f / 16); }

FRESHET_WIDE void add_even(const float* a, const float* b, const float* c, float gain, int n, float* sum) {
  for (int i = 0; i < n; ++i) sum[i] = sum[i] * gain + even_row(a[i], b[i], c[i]);
}
FRESHET_WIDE void add_odd(const float* b, const float* c, float gain, int n, float* sum) {
  for (int i = 0; i < n; ++i) sum[i] = sum[i] * gain + odd_row(b[i], c[i]);
}
FRESHET_WIDE void less_even(const float* from, const float* a, const float* b, const float* c, int n,
                            float* out) {
  for (int i = 0; i < n; ++i) out[i] = from[i] - even_row(a[i], b[i], c[i]);
}
FRESHET_WIDE void less_odd(const float* from, const float* b, const float* c, int n, float* out) {
  for (int i = 0; i < n; ++i) out[i] = from[i] - odd_row(b[i], c[i]);
}

/// Calls even(y, a, b, c) and odd(y, b, c) with the widened rows that row y of a picture of `rows` rows is made of.
template <class Even, class Odd>
void each_widened(const cv::Mat& small, int rows, const Even& even, const Odd& odd) {
  const int width = 2 * small.cols;
  std::vector<float> ring(static_cast<std::size_t>(width) * 3);
  const auto line = [&](int y) { return ring.data() + static_cast<std::ptrdiff_t>(width) * ((y + 3) % 3); };
  for (int y = 0, next = -1; y < small.rows; ++y) {
    for (; next <= y + 1; ++next) {
      const int row = next < 0 ? std::min(1, small.rows - 1) : std::min(next, small.rows - 1);
      widen_row(small.ptr<float>(row), small.cols, line(next));
    }
    even(2 * y, line(y - 1), line(y), line(y + 1));
    if (2 * y + 1 < rows) odd(2 * y + 1, line(y), line(y + 1));
  }
}

/// What the rows above are for: planes of one channel, neither side of which is all edge.
bool is_plane(const cv::Mat& picture) {
  return picture.type() == CV_32F && std::min(picture.cols, picture.rows) > 4;
}

/// The low-pass half of a picture, and what it lacks.
void split(const cv::Mat& picture, cv::Mat& smaller, cv::Mat& band) {
  if (!is_plane(picture)) {
    cv::Mat blurred;
    cv::pyrDown(picture, smaller);
    cv::pyrUp(smaller, blurred, picture.size());
    cv::subtract(picture, blurred, band);
    return;
  }
  reduce(picture, smaller);
  band.create(picture.size(), CV_32F);
  each_widened(
      smaller, picture.rows,
      [&](int y, const float* a, const float* b, const float* c) {
        less_even(picture.ptr<float>(y), a, b, c, picture.cols, band.ptr<float>(y));
      },
      [&](int y, const float* b, const float* c) {
        less_odd(picture.ptr<float>(y), b, c, picture.cols, band.ptr<float>(y));
      });
}

/// sum = sum * gain + small at the size of sum.
void add_widened(const cv::Mat& small, float gain, cv::Mat& sum) {
  if (!is_plane(sum)) {
    cv::Mat larger;
    cv::pyrUp(small, larger, sum.size());
    cv::scaleAdd(sum, gain, larger, sum);
    return;
  }
  each_widened(
      small, sum.rows,
      [&](int y, const float* a, const float* b, const float* c) {
        add_even(a, b, c, gain, sum.cols, sum.ptr<float>(y));
      },
      [&](int y, const float* b, const float* c) { add_odd(b, c, gain, sum.cols, sum.ptr<float>(y)); });
}

}  // namespace

void laplacian_pyramid(const cv::Mat& picture, int levels, std::vector<cv::Mat>& bands) {
  if (picture.empty() || levels < 0) {
    throw Error(ErrorKind::kUsage, "pyramid", "a picture and a number of levels from 0 expected");
  }
  bands.resize(static_cast<std::size_t>(levels) + 1);
  cv::Mat rest = picture, smaller;
  if (picture.depth() != CV_32F) picture.convertTo(rest, CV_32F);
  for (int level = 0; level < levels; ++level) {
    split(rest, smaller, bands[level]);
    rest = smaller;
    smaller.release();
  }
  rest.copyTo(bands[levels]);
}

int levels_within(cv::Size picture, int wanted) {
  constexpr int kLeastRest = 4;
  while (wanted > 0 && (std::min(picture.width, picture.height) >> wanted) < kLeastRest) --wanted;
  return wanted;
}

cv::Mat collapse(const std::vector<cv::Mat>& bands) {
  std::vector<cv::Mat> own;
  for (const cv::Mat& band : bands) own.push_back(band.clone());
  return collapse(std::move(own));
}

cv::Mat collapse(std::vector<cv::Mat>&& bands, std::span<const float> gains) {
  if (bands.empty()) throw Error(ErrorKind::kUsage, "pyramid", "no bands to collapse");
  for (std::size_t level = bands.size() - 1; level-- > 0;)
    add_widened(bands[level + 1], level < gains.size() ? gains[level] : 1.0f, bands[level]);
  return bands.front();
}

}  // namespace freshet::vision
