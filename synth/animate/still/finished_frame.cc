#include "synth/animate/still/finished_frame.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "platform/vectors.h"

namespace freshet::synth::animate {
namespace {

// Luma keeps what the chroma of the other two gives it.
FRESHET_WIDE void green_chroma(const float* blue, const float* red, int n, float* green) {
  for (int i = 0; i < n; ++i) green[i] = -(kBlueLuma * blue[i] + kRedLuma * red[i]) / kGreenLuma;
}

/// Rows of one frame: how far what was carried shows, and its colour less luma.
struct CarriedRow {
  std::array<std::vector<float>, 3> chroma;
  std::vector<float> fraction;

  explicit CarriedRow(std::size_t width) : fraction(width) {
    for (auto& row : chroma) row.resize(width);
  }
  void read(const CarriedFrame& frame, const ColourCurve& curve, const float* luma, int y) {
    const int width = frame.luma.cols;
    colour_row(frame, y, width, chroma[0].data(), chroma[2].data(), fraction.data());
    curve.follow(frame.luma.ptr<std::int16_t>(y), luma, width, chroma[0].data(), chroma[2].data());
    green_chroma(chroma[0].data(), chroma[2].data(), width, chroma[1].data());
  }
};

// One channel of a row. chroma: of what was carried, as its luminance is now.
FRESHET_WIDE void light(const float* luma, const float* slope, const float* rest, const float* still,
                        const float* fluid, const float* chroma, const float* fraction, int n,
                        std::uint8_t* out) {
  for (int i = 0; i < n; ++i) {
    const float fresh = luma[i] + slope[i] * luma[i] + rest[i];
    const float brought = luma[i] + chroma[i];
    const float lit = fresh + fraction[i] * (brought - fresh);
    const float shown = std::min(std::max(lit, 0.0f), 1.0f);
    out[i] = static_cast<std::uint8_t>(255 * fluid[i] * shown + (1 - fluid[i]) * still[i] + 0.5f);
  }
}

FRESHET_WIDE void light_alone(const float* luma, const float* slope, const float* rest, const float* still,
                              const float* fluid, int n, std::uint8_t* out) {
  for (int i = 0; i < n; ++i) {
    const float shown = std::min(std::max(luma[i] + slope[i] * luma[i] + rest[i], 0.0f), 1.0f);
    out[i] = static_cast<std::uint8_t>(255 * fluid[i] * shown + (1 - fluid[i]) * still[i] + 0.5f);
  }
}

// The same without what lies below: colour times matte.
FRESHET_WIDE void light_fluid(const float* luma, const float* slope, const float* rest, const float* fluid,
                              float brightest, int n, float* out) {
  for (int i = 0; i < n; ++i)
    out[i] = fluid[i] * std::min(std::max(luma[i] + slope[i] * luma[i] + rest[i], 0.0f), brightest);
}

FRESHET_WIDE void light_carried_fluid(const float* luma, const float* slope, const float* rest,
                                      const float* fluid, const float* chroma, const float* fraction,
                                      float brightest, int n, float* out) {
  for (int i = 0; i < n; ++i) {
    const float fresh = luma[i] + slope[i] * luma[i] + rest[i];
    const float brought = luma[i] + chroma[i];
    const float lit = fresh + fraction[i] * (brought - fresh);
    out[i] = fluid[i] * std::min(std::max(lit, 0.0f), brightest);
  }
}

FRESHET_WIDE void interleave(const std::uint8_t* blue, const std::uint8_t* green, const std::uint8_t* red,
                             int n, std::uint8_t* out) {
  for (int i = 0; i < n; ++i) {
    out[3 * i] = blue[i];
    out[3 * i + 1] = green[i];
    out[3 * i + 2] = red[i];
  }
}

}  // namespace

FrameFinisher::FrameFinisher(const ColourModel& model, const ColourCurve& curve, const cv::Mat& own_colour,
                             const cv::Mat& still)
    : curve_(curve) {
  still.convertTo(ground_, CV_8U, 255);
  cv::split(model.slope, slope_.data());
  cv::split(model.offset + own_colour, rest_.data());
  cv::split(still * 255, still_.data());
  double brightest = 1;
  cv::minMaxLoc(still.reshape(1), nullptr, &brightest);
  brightest_ = std::max(1.0f, static_cast<float>(brightest));
}

cv::Mat FrameFinisher::finish(const cv::Mat& luma, const cv::Mat& fluid, const CarriedFrame* carried) const {
  cv::Mat frame = ground_.clone();
  const std::size_t width = static_cast<std::size_t>(frame.cols);
  CarriedRow row_of_carried(carried ? width : 0);
  std::array<std::vector<std::uint8_t>, 3> lit;
  for (auto& row : lit) row.resize(width);
  for (int y = 0; y < frame.rows; ++y) {
    const float* b = fluid.ptr<float>(y);
    int begin = 0, end = frame.cols;
    while (begin < end && b[begin] <= 0) ++begin;
    while (end > begin && b[end - 1] <= 0) --end;
    if (begin == end) continue;
    if (carried) row_of_carried.read(*carried, curve_, luma.ptr<float>(y), y);
    for (int k = 0; k < 3; ++k) {
      const float *l = luma.ptr<float>(y) + begin, *slope = slope_[k].ptr<float>(y) + begin;
      const float *rest = rest_[k].ptr<float>(y) + begin, *still = still_[k].ptr<float>(y) + begin;
      if (carried)
        light(l, slope, rest, still, b + begin, row_of_carried.chroma[k].data() + begin,
              row_of_carried.fraction.data() + begin, end - begin, lit[k].data());
      else
        light_alone(l, slope, rest, still, b + begin, end - begin, lit[k].data());
    }
    interleave(lit[0].data(), lit[1].data(), lit[2].data(), end - begin, frame.ptr(y) + 3 * begin);
  }
  return frame;
}

cv::Mat FrameFinisher::finish_fluid(const cv::Mat& luma, const cv::Mat& fluid,
                                    const CarriedFrame* carried) const {
  const int width = luma.cols;
  cv::Mat frame(luma.size(), CV_32FC4);
  std::array<std::vector<float>, 3> lit;
  for (auto& row : lit) row.resize(static_cast<std::size_t>(width));
  CarriedRow row_of_carried(carried ? static_cast<std::size_t>(width) : 0);
  for (int y = 0; y < frame.rows; ++y) {
    const float *l = luma.ptr<float>(y), *a = fluid.ptr<float>(y);
    if (carried) row_of_carried.read(*carried, curve_, l, y);
    for (int k = 0; k < 3; ++k) {
      const float *slope = slope_[k].ptr<float>(y), *rest = rest_[k].ptr<float>(y);
      if (carried)
        light_carried_fluid(l, slope, rest, a, row_of_carried.chroma[k].data(),
                            row_of_carried.fraction.data(), brightest_, width, lit[k].data());
      else
        light_fluid(l, slope, rest, a, brightest_, width, lit[k].data());
    }
    float* out = frame.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      for (int k = 0; k < 3; ++k) out[4 * x + k] = lit[k][static_cast<std::size_t>(x)];
      out[4 * x + 3] = std::clamp(a[x], 0.0f, 1.0f);
    }
  }
  return frame;
}

}  // namespace freshet::synth::animate
