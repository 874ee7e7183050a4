#include "vision/dot.h"

#include <cmath>
#include <cstddef>
#include <numeric>

#include "platform/vectors.h"

namespace freshet::vision {
namespace {

constexpr std::size_t kSums = 8;  // each of every eighth product: what vectors of any width add in one order

FRESHET_WIDE void add_products(const float* one, const float* other, std::size_t n, double* sums) {
  std::size_t i = 0;
  for (; i + kSums <= n; i += kSums)
    for (std::size_t k = 0; k < kSums; ++k)
      sums[k] += static_cast<double>(one[i + k]) * static_cast<double>(other[i + k]);
  for (; i < n; ++i) sums[i % kSums] += static_cast<double>(one[i]) * static_cast<double>(other[i]);
}

FRESHET_WIDE void add_products_of_magnitudes(const float* one, const float* other, std::size_t n,
                                             double* sums) {
  std::size_t i = 0;
  for (; i + kSums <= n; i += kSums)
    for (std::size_t k = 0; k < kSums; ++k)
      sums[k] += static_cast<double>(std::abs(one[i + k])) * static_cast<double>(other[i + k]);
  for (; i < n; ++i) sums[i % kSums] += static_cast<double>(std::abs(one[i])) * static_cast<double>(other[i]);
}

template <class AddRow>
double sum_of(const cv::Mat& one, const cv::Mat& other, const AddRow& add_row) {
  CV_Assert(one.depth() == CV_32F && one.type() == other.type() && one.size() == other.size());
  double sums[kSums] = {};
  const std::size_t n = static_cast<std::size_t>(one.cols) * static_cast<std::size_t>(one.channels());
  for (int y = 0; y < one.rows; ++y) add_row(one.ptr<float>(y), other.ptr<float>(y), n, sums);
  return std::accumulate(sums, sums + kSums, 0.0);
}

}  // namespace

double dot(const cv::Mat& one, const cv::Mat& other) { return sum_of(one, other, add_products); }

double dot_of_magnitudes(const cv::Mat& one, const cv::Mat& other) {
  return sum_of(one, other, add_products_of_magnitudes);
}

}  // namespace freshet::vision
