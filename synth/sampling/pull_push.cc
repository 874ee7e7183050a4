#include "synth/sampling/pull_push.h"

#include <algorithm>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::sampling {
namespace {

constexpr float kMinWeight = 1e-6f;  // weight below which a sample counts as unknown

/// values * weight, channel by channel.
cv::Mat weighted(const cv::Mat& values, const cv::Mat& weight) {
  cv::Mat wide;
  cv::merge(std::vector<cv::Mat>(values.channels(), weight), wide);
  return values.mul(wide);
}

/// In place: values / weight where there is any, else 0.
void divide_by(cv::Mat& values, const cv::Mat& weight) {
  const int channels = values.channels();
  for (int y = 0; y < values.rows; ++y) {
    float* v = values.ptr<float>(y);
    const float* w = weight.ptr<float>(y);
    for (int x = 0; x < values.cols; ++x)
      for (int k = 0; k < channels; ++k)
        v[x * channels + k] = w[x] > kMinWeight ? v[x * channels + k] / w[x] : 0.0f;
  }
}

}  // namespace

cv::Mat pull_push(const cv::Mat& values, const cv::Mat& weight) {
  // Pull: each level halves the picture, and half of what is known in a neighbourhood makes it known.
  std::vector<cv::Mat> level{values}, trust{weight};
  while (std::max(level.back().cols, level.back().rows) > 1) {
    cv::Mat sum, mass;
    cv::pyrDown(weighted(level.back(), trust.back()), sum, {}, cv::BORDER_REPLICATE);
    cv::pyrDown(trust.back(), mass, {}, cv::BORDER_REPLICATE);
    divide_by(sum, mass);
    level.push_back(sum);
    trust.push_back(cv::min(2 * mass, 1.0f));
  }
  // Push: what is unknown at a level comes from the coarser one.
  cv::Mat out = level.back(), up;
  for (std::size_t i = level.size() - 1; i-- > 0;) {
    cv::pyrUp(out, up, level[i].size());
    const int channels = values.channels();
    for (int y = 0; y < up.rows; ++y) {
      float* to = up.ptr<float>(y);
      const float* from = level[i].ptr<float>(y);
      const float* w = trust[i].ptr<float>(y);
      for (int x = 0; x < up.cols; ++x)
        for (int k = 0; k < channels; ++k) {
          const int at = x * channels + k;
          to[at] = w[x] >= 1 ? from[at] : to[at] + w[x] * (from[at] - to[at]);
        }
    }
    cv::swap(out, up);
  }
  return out.data == values.data ? values.clone() : out;
}

}  // namespace freshet::synth::sampling
