#include "media/picture/passes.h"

#include <algorithm>
#include <cstdint>

#include "media/picture/light.h"

namespace freshet::media {
namespace {

/// Of a fluid times alpha, its own colour: sRGB code, or linear light.
cv::Vec3f own_colour(const cv::Vec4f& fluid, bool light) {
  cv::Vec3f own;
  if (fluid[3] <= 0) return own;
  for (int k = 0; k < 3; ++k) own[k] = light ? linear_of(fluid[k] / fluid[3]) : fluid[k] / fluid[3];
  return own;
}

template <class Sample>
Sample sample_of(float value) {
  if constexpr (std::is_same_v<Sample, float>)
    return value;
  else
    return cv::saturate_cast<Sample>(value * static_cast<float>(std::numeric_limits<Sample>::max()));
}

template <class Sample, class Pixel>
void fill(cv::Mat& out, const Pixel& pixel) {
  const int channels = out.channels();
  for (int y = 0; y < out.rows; ++y) {
    Sample* to = out.ptr<Sample>(y);
    for (int x = 0; x < out.cols; ++x) {
      const cv::Vec4f value = pixel(cv::Point(x, y));
      for (int k = 0; k < channels; ++k) *to++ = sample_of<Sample>(value[k]);
    }
  }
}

}  // namespace

Layers::Layers(const cv::Mat& below, const cv::Mat& original, const cv::Mat& matte, Layer layer,
               AlphaForm alpha, Samples samples)
    : below_(below),
      below_light_(samples == Samples::kLight ? to_linear(below) : cv::Mat()),
      original_(original),
      matte_(matte),
      layer_(layer),
      alpha_(alpha),
      samples_(samples) {}

void Layers::whole(const cv::Vec4f& fluid, const cv::Point& at, cv::Vec3f& out) const {
  const float rest = 1 - fluid[3];
  if (samples_ != Samples::kLight) {
    const cv::Vec3f& below = below_.at<cv::Vec3f>(at);
    for (int k = 0; k < 3; ++k) out[k] = fluid[k] + rest * below[k];
  } else if (fluid[3] <= 0 && matte_.at<std::uint8_t>(at) == 0 && original_.depth() == CV_32F) {
    out = original_.at<cv::Vec3f>(at);  // not by way of the curve and back
  } else {
    const cv::Vec3f own = own_colour(fluid, true), &below = below_light_.at<cv::Vec3f>(at);
    for (int k = 0; k < 3; ++k) out[k] = fluid[3] * own[k] + rest * below[k];
  }
}

cv::Mat Layers::frame(const cv::Mat& fluid) const {
  const bool light = samples_ == Samples::kLight;
  const auto pixel = [&](const cv::Point& at) {
    const cv::Vec4f& f = fluid.at<cv::Vec4f>(at);
    if (layer_ == Layer::kFluid) {
      if (alpha_ == AlphaForm::kPremultiplied && !light) return f;
      cv::Vec3f own = own_colour(f, light);
      if (alpha_ == AlphaForm::kPremultiplied) own *= f[3];
      return cv::Vec4f(own[0], own[1], own[2], f[3]);
    }
    cv::Vec3f value;
    whole(f, at, value);
    if (layer_ == Layer::kLight) {
      const cv::Vec3f& below = (light ? below_light_ : below_).at<cv::Vec3f>(at);
      for (int k = 0; k < 3; ++k) value[k] = std::max(0.0f, value[k] - below[k]);
    }
    return cv::Vec4f(value[0], value[1], value[2], 1);
  };
  const int channels = layer_ == Layer::kFluid ? 4 : 3;
  const int depth = samples_ == Samples::k8 ? CV_8U : light ? CV_32F : CV_16U;
  cv::Mat out(fluid.size(), CV_MAKETYPE(depth, channels));
  if (depth == CV_8U)
    fill<std::uint8_t>(out, pixel);
  else if (depth == CV_16U)
    fill<std::uint16_t>(out, pixel);
  else
    fill<float>(out, pixel);
  return out;
}

cv::Mat Layers::shown(const cv::Mat& fluid) const {
  cv::Mat out(fluid.size(), CV_8UC3);
  fill<std::uint8_t>(out, [&](const cv::Point& at) {
    const cv::Vec4f& f = fluid.at<cv::Vec4f>(at);
    const cv::Vec3f& below = below_.at<cv::Vec3f>(at);
    return cv::Vec4f(f[0] + (1 - f[3]) * below[0], f[1] + (1 - f[3]) * below[1], f[2] + (1 - f[3]) * below[2],
                     1);
  });
  return out;
}

}  // namespace freshet::media
