#include "synth/animate/still/colour_model.h"

#include <array>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

/// A window mean weighted by the matte, smooth: three box filters make nearly a Gaussian, so that the
/// window's edge does not show.
cv::Mat window_mean(const cv::Mat& values, int radius) {
  const int side = 2 * (radius / 2) + 1;
  cv::Mat out;
  cv::blur(values, out, {side, side});
  cv::blur(out, out, {side, side});
  cv::blur(out, out, {side, side});
  return out;
}

}  // namespace

cv::Mat luma_of(const cv::Mat& bgr) {
  cv::Mat luma;
  cv::transform(bgr, luma, cv::Matx13f(kBlueLuma, kGreenLuma, kRedLuma));
  return luma;
}

ColourModel fit_colour(const cv::Mat& bgr, const cv::Mat& luma, const cv::Mat& matte, int radius,
                       double ridge) {
  const cv::Mat weight =
      matte + 1e-3;  // beyond the matte the nearest fluid counts, and the picture where there is none
  const cv::Mat mass = window_mean(weight, radius);
  const auto mean_of = [&](const cv::Mat& values) -> cv::Mat {
    return window_mean(values.mul(weight), radius) / mass;
  };
  const cv::Mat mean_luma = mean_of(luma);
  const cv::Mat variance = cv::max(mean_of(luma.mul(luma)) - mean_luma.mul(mean_luma), 0) + ridge;
  std::array<cv::Mat, 3> channel, slope, offset;
  cv::split(bgr, channel.data());
  for (int k = 0; k < 3; ++k) {
    const cv::Mat chroma = channel[k] - luma;
    const cv::Mat mean_chroma = mean_of(chroma);
    slope[k] = (mean_of(chroma.mul(luma)) - mean_chroma.mul(mean_luma)) / variance;
    offset[k] = mean_chroma - slope[k].mul(mean_luma);
    // A pixel is coloured by the average of all windows that hold it.
    slope[k] = mean_of(slope[k]);
    offset[k] = mean_of(offset[k]);
  }
  ColourModel model;
  cv::merge(slope.data(), 3, model.slope);
  cv::merge(offset.data(), 3, model.offset);
  return model;
}

void apply_colour(const ColourModel& model, const cv::Mat& luma, cv::Mat& bgr) {
  bgr.create(luma.size(), CV_32FC3);
  for (int y = 0; y < luma.rows; ++y) {
    const float* l = luma.ptr<float>(y);
    const cv::Vec3f* slope = model.slope.ptr<cv::Vec3f>(y);
    const cv::Vec3f* offset = model.offset.ptr<cv::Vec3f>(y);
    cv::Vec3f* out = bgr.ptr<cv::Vec3f>(y);
    for (int x = 0; x < luma.cols; ++x)
      for (int k = 0; k < 3; ++k) out[x][k] = l[x] + slope[x][k] * l[x] + offset[x][k];
  }
}

}  // namespace freshet::synth::animate
