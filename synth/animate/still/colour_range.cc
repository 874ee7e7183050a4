#include "synth/animate/still/colour_range.h"

#include <algorithm>
#include <limits>

#include "platform/vectors.h"
#include "synth/animate/still/colour_model.h"

namespace freshet::synth::animate {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

[[gnu::always_inline]] inline float within(float value, float least, float most, float own) {
  const float low = own < least ? own : least, high = most < own ? own : most;
  const float above = value < low ? low : value;
  return high < above ? high : above;
}

FRESHET_WIDE void limit_row(const float* luma, const std::uint16_t* still_blue,
                            const std::uint16_t* still_green, const std::uint16_t* still_red, float unit,
                            const float* least_blue, const float* most_blue, const float* least_red,
                            const float* most_red, float steps, int n, float* blue, float* red) {
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float at = steps * luma[i];
    const float a0 = at > 0.0f ? at : 0.0f, a = a0 < steps ? a0 : steps;  // 0 where it is no number
    const int below = static_cast<int>(a);
    const float beyond = a - static_cast<float>(below);
    const auto own_blue = static_cast<float>(still_blue[i]), own_green = static_cast<float>(still_green[i]),
               own_red = static_cast<float>(still_red[i]);
    const float own_luma = kBlueLuma * own_blue + kGreenLuma * own_green + kRedLuma * own_red;
    const float b0 = least_blue[below], b1 = most_blue[below], r0 = least_red[below], r1 = most_red[below];
    blue[i] = within(blue[i], b0 + beyond * (least_blue[below + 1] - b0),
                     b1 + beyond * (most_blue[below + 1] - b1), unit * (own_blue - own_luma));
    red[i] = within(red[i], r0 + beyond * (least_red[below + 1] - r0),
                    r1 + beyond * (most_red[below + 1] - r1), unit * (own_red - own_luma));
  }
}

}  // namespace

ColourRange::ColourRange(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte) {
  std::array<Ends, 2> found;
  for (Ends& of : found) {
    of.least.fill(kNone);
    of.most.fill(-kNone);
  }
  for (int y = 0; y < luma.rows; ++y)
    for (int x = 0; x < luma.cols; ++x) {
      if (matte.at<float>(y, x) <= 0) continue;
      const float l = luma.at<float>(y, x);
      const cv::Vec3f& colour = bgr.at<cv::Vec3f>(y, x);
      const auto step = static_cast<std::size_t>(cvRound(std::clamp(l, 0.0f, 1.0f) * kSteps));
      for (std::size_t k = 0; k < found.size(); ++k) {
        const float chroma = colour[2 * static_cast<int>(k)] - l;
        found[k].least[step] = std::min(found[k].least[step], chroma);
        found[k].most[step] = std::max(found[k].most[step], chroma);
      }
    }
  // Every pixel lies within both ends of its step. Where there is none the next known on both sides count.
  for (std::size_t step = 0; step <= kSteps; ++step) {
    std::size_t first = step > 0 ? step - 1 : 0, last = std::min<std::size_t>(step + 1, kSteps);
    const auto known = [&](std::size_t at) { return found[0].least[at] <= found[0].most[at]; };
    const auto any = [&] {
      for (std::size_t at = first; at <= last; ++at)
        if (known(at)) return true;
      return false;
    };
    if (!any()) {
      while (first > 0 && !known(first)) --first;
      while (last < kSteps && !known(last)) ++last;
    }
    for (std::size_t k = 0; k < found.size(); ++k)
      for (std::size_t at = first; at <= last; ++at) {
        float &least = ends_[k].least[step], &most = ends_[k].most[step];
        least = at == first ? found[k].least[at] : std::min(least, found[k].least[at]);
        most = at == first ? found[k].most[at] : std::max(most, found[k].most[at]);
      }
  }
  limits_ = ends_[0].least[0] < kNone;
  for (Ends& of : ends_) {
    of.least.back() = of.least[kSteps];
    of.most.back() = of.most[kSteps];
  }
}

void ColourRange::limit(const float* luma, const std::array<const std::uint16_t*, 3>& still, float white,
                        int n, float* blue, float* red) const {
  if (!limits_) return;
  limit_row(luma, still[0], still[1], still[2], 1 / white, ends_[0].least.data(), ends_[0].most.data(),
            ends_[1].least.data(), ends_[1].most.data(), kSteps, n, blue, red);
}

}  // namespace freshet::synth::animate
