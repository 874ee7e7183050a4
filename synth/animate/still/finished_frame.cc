#include "synth/animate/still/finished_frame.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "platform/vectors.h"

namespace freshet::synth::animate {
namespace {

constexpr float kOfLevel = 128;

FRESHET_WIDE void chroma_row(const float* luma, const float* slope, const float* rest, int n, float* chroma) {
  for (int i = 0; i < n; ++i) chroma[i] = slope[i] * luma[i] + rest[i];
}

FRESHET_WIDE void bring(const float* brought, const float* fraction, int n, float* chroma) {
  for (int i = 0; i < n; ++i) chroma[i] += fraction[i] * (brought[i] - chroma[i]);
}

// Luma keeps what the chroma of the other two gives it.
FRESHET_WIDE void green_chroma(const float* blue, const float* red, int n, float* green) {
  for (int i = 0; i < n; ++i) green[i] = -(kBlueLuma * blue[i] + kRedLuma * red[i]) / kGreenLuma;
}

// One channel of a row.
FRESHET_WIDE void light(const float* luma, const float* chroma, const std::uint16_t* still,
                        const float* fluid, int n, std::uint8_t* out) {
  for (int i = 0; i < n; ++i) {
    const float shown = std::min(std::max(luma[i] + chroma[i], 0.0f), 1.0f);
    const float below = static_cast<float>(still[i]) * (1 / kOfLevel);
    out[i] = static_cast<std::uint8_t>(255 * fluid[i] * shown + (1 - fluid[i]) * below + 0.5f);
  }
}

// The same without what lies below: colour times matte.
FRESHET_WIDE void light_fluid(const float* luma, const float* chroma, const float* fluid, float brightest,
                              int n, float* out) {
  for (int i = 0; i < n; ++i) out[i] = fluid[i] * std::min(std::max(luma[i] + chroma[i], 0.0f), brightest);
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

/// A row of one frame: its colours less luma.
struct FrameFinisher::Row {
  std::array<std::vector<float>, 3> chroma;
  std::vector<float> blue, red, fraction;  // of what is carried

  Row(int width, bool carries) {
    for (auto& row : chroma) row.resize(static_cast<std::size_t>(width));
    if (carries)
      for (auto* row : {&blue, &red, &fraction}) row->resize(static_cast<std::size_t>(width));
  }
  /// Of its samples from `begin` on, before `end`.
  void read(const FrameFinisher& of, const float* luma, const CarriedFrame* carried, int y, int begin,
            int end) {
    const int width = static_cast<int>(chroma[0].size()), n = end - begin;
    const auto own = [&](const Chroma& of_model, std::vector<float>& out) {
      chroma_row(luma + begin, of_model.slope.ptr<float>(y) + begin, of_model.rest.ptr<float>(y) + begin, n,
                 out.data() + begin);
    };
    own(of.blue_, chroma[0]);
    own(of.red_, chroma[2]);
    if (carried) {
      colour_row(*carried, y, width, blue.data(), red.data(), fraction.data());
      of.curve_.follow(carried->luma.ptr<std::int16_t>(y), luma, width, blue.data(), red.data());
      bring(blue.data() + begin, fraction.data() + begin, n, chroma[0].data() + begin);
      bring(red.data() + begin, fraction.data() + begin, n, chroma[2].data() + begin);
    }
    std::array<const std::uint16_t*, 3> still{};
    for (std::size_t k = 0; k < 3; ++k) still[k] = of.still_[k].ptr<std::uint16_t>(y) + begin;
    of.range_.limit(luma + begin, still, 255 * kOfLevel, n, chroma[0].data() + begin,
                    chroma[2].data() + begin);
    green_chroma(chroma[0].data() + begin, chroma[2].data() + begin, n, chroma[1].data() + begin);
  }
};

FrameFinisher::FrameFinisher(const ColourModel& model, const ColourCurve& curve, const cv::Mat& own_colour,
                             const cv::Mat& still, const ColourRange& range)
    : curve_(curve), range_(range) {
  const auto chroma_of = [&](int channel, Chroma& out) {
    cv::Mat own;
    cv::extractChannel(model.slope, out.slope, channel);
    cv::extractChannel(model.offset, out.rest, channel);
    cv::extractChannel(own_colour, own, channel);
    out.rest += own;
  };
  chroma_of(0, blue_);
  chroma_of(2, red_);
  cv::Mat levels;
  still.convertTo(levels, CV_16U, 255 * kOfLevel);
  levels = cv::min(levels, 255 * kOfLevel);
  levels.convertTo(ground_, CV_8U, 1 / kOfLevel, 1e-3);  // halves up, as light() rounds
  cv::split(levels, still_.data());
  double brightest = 1;
  cv::minMaxLoc(still.reshape(1), nullptr, &brightest);
  brightest_ = std::max(1.0f, static_cast<float>(brightest));
}

cv::Mat FrameFinisher::finish(const cv::Mat& luma, const cv::Mat& fluid, const CarriedFrame* carried) const {
  cv::Mat frame = ground_.clone();
  Row row(frame.cols, carried != nullptr);
  std::array<std::vector<std::uint8_t>, 3> lit;
  for (auto& channel : lit) channel.resize(static_cast<std::size_t>(frame.cols));
  for (int y = 0; y < frame.rows; ++y) {
    const float *l = luma.ptr<float>(y), *a = fluid.ptr<float>(y);
    int begin = 0, end = frame.cols;
    while (begin < end && a[begin] <= 0) ++begin;
    while (end > begin && a[end - 1] <= 0) --end;
    if (begin == end) continue;
    row.read(*this, l, carried, y, begin, end);
    for (std::size_t k = 0; k < 3; ++k)
      light(l + begin, row.chroma[k].data() + begin, still_[k].ptr<std::uint16_t>(y) + begin, a + begin,
            end - begin, lit[k].data());
    interleave(lit[0].data(), lit[1].data(), lit[2].data(), end - begin, frame.ptr(y) + 3 * begin);
  }
  return frame;
}

cv::Mat FrameFinisher::finish_fluid(const cv::Mat& luma, const cv::Mat& fluid,
                                    const CarriedFrame* carried) const {
  const int width = luma.cols;
  cv::Mat frame(luma.size(), CV_32FC4);
  Row row(width, carried != nullptr);
  std::array<std::vector<float>, 3> lit;
  for (auto& channel : lit) channel.resize(static_cast<std::size_t>(width));
  for (int y = 0; y < frame.rows; ++y) {
    const float *l = luma.ptr<float>(y), *a = fluid.ptr<float>(y);
    row.read(*this, l, carried, y, 0, width);
    for (std::size_t k = 0; k < 3; ++k)
      light_fluid(l, row.chroma[k].data(), a, brightest_, width, lit[k].data());
    float* out = frame.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      for (std::size_t k = 0; k < 3; ++k)
        out[4 * x + static_cast<int>(k)] = lit[k][static_cast<std::size_t>(x)];
      out[4 * x + 3] = std::clamp(a[x], 0.0f, 1.0f);
    }
  }
  return frame;
}

}  // namespace freshet::synth::animate
