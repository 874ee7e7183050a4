#include "synth/animate/still/standing_colour.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/sampling/widened_rows.h"

namespace freshet::synth::animate {
namespace {

constexpr int kCells = 48;                // along the longer side, in which means are taken
constexpr double kReach = kCells / 12.0;  // cells: sigma
constexpr double kLeastMass = 1e-4;
// A Gaussian passes only a part of what is as wide as a quarter of the picture: what is left of it is taken away again.
// Of a wavelength of half the longer side .18 and .07 stay, of a quarter .8 and .7.
constexpr int kLumaPasses = 2, kColourPasses = 3;

cv::Mat around(const cv::Mat& cells) {
  cv::Mat out;
  cv::GaussianBlur(cells, out, {}, kReach, kReach, cv::BORDER_REPLICATE);
  return out;
}

FRESHET_WIDE void add_row(sampling::WidenedRows::Row more, int n, float* to) {
  for (int x = 0; x < n; ++x) to[x] += more.at(x);
}
FRESHET_WIDE void add_row(sampling::WidenedRows::Row more, int n, std::int16_t* to) {
  constexpr float kMost = 32767, kWhole = 12582912;  // 1.5 * 2^23: what is added to it has no fraction left
  for (int x = 0; x < n; ++x) {
    const float sum = static_cast<float>(to[x]) + more.at(x);
    const float low = sum > -kMost ? sum : -kMost, inside = low < kMost ? low : kMost;
    to[x] = static_cast<std::int16_t>(static_cast<int>((inside + kWhole) - kWhole));
  }
}

FRESHET_WIDE void weigh_row(const float* own, const float* plane, const float* weight, int n, float* out) {
  for (int x = 0; x < n; ++x) out[x] = (own[x] - plane[x]) * weight[x];
}
FRESHET_WIDE void weigh_row(const std::int16_t* own, const std::int16_t* plane, const float* weight, int n,
                            float* out) {
  for (int x = 0; x < n; ++x) out[x] = static_cast<float>(own[x] - plane[x]) * weight[x];
}

template <class Value>
cv::Mat weighed_difference(const cv::Mat& own, const cv::Mat& plane, const cv::Mat& weight) {
  cv::Mat out(plane.size(), CV_32F);
  for (int y = 0; y < out.rows; ++y)
    weigh_row(own.ptr<Value>(y), plane.ptr<Value>(y), weight.ptr<float>(y), out.cols, out.ptr<float>(y));
  return out;
}

}  // namespace

StandingColour::StandingColour(const FluidPlanes& planes, const cv::Mat& matte)
    : luma_(planes.luma), matte_(matte) {
  const cv::Size half((matte.cols + 1) / 2, (matte.rows + 1) / 2);
  const std::array<const cv::Mat*, 2> colours{&planes.blue, &planes.red};
  for (std::size_t k = 0; k < colour_.size(); ++k) {
    cv::Mat reduced;
    cv::resize(*colours[k], reduced, half, 0, 0, cv::INTER_AREA);
    reduced.convertTo(colour_[k], CV_16S, CarriedFrame::kOne);
  }
  cv::resize(matte, half_matte_, half, 0, 0, cv::INTER_AREA);
  const double unit = kCells / static_cast<double>(std::max(matte.cols, matte.rows));
  const auto cells = [unit](int n) { return std::max(1, static_cast<int>(std::lround(unit * n))); };
  cv::resize(matte, cells_, {cells(matte.cols), cells(matte.rows)}, 0, 0, cv::INTER_AREA);
  mass_ = cv::max(around(cells_), kLeastMass);
}

void StandingColour::hold(cv::Mat& luma, CarriedFrame* frame, double share) const {
  hold_mean(luma_, matte_, kLumaPasses, share, luma);
  if (!frame) return;
  hold_mean(colour_[0], half_matte_, kColourPasses, share, frame->blue);
  hold_mean(colour_[1], half_matte_, kColourPasses, share, frame->red);
}

void StandingColour::hold_mean(const cv::Mat& own, const cv::Mat& weight, int passes, double share,
                               cv::Mat& plane) const {
  const cv::Mat away = plane.depth() == CV_32F ? weighed_difference<float>(own, plane, weight)
                                               : weighed_difference<std::int16_t>(own, plane, weight);
  cv::Mat left, all = cv::Mat::zeros(mass_.size(), CV_32F);
  cv::resize(away, left, mass_.size(), 0, 0, cv::INTER_AREA);
  for (int pass = 0; pass < passes; ++pass) {
    const cv::Mat mean = around(left) / mass_;
    all += mean;
    left -= mean.mul(cells_);
  }
  all *= share;
  sampling::WidenedRows more(all, plane.size());
  for (int y = 0; y < plane.rows; ++y) {
    if (plane.depth() == CV_32F)
      add_row(more.at(y), plane.cols, plane.ptr<float>(y));
    else
      add_row(more.at(y), plane.cols, plane.ptr<std::int16_t>(y));
  }
}

}  // namespace freshet::synth::animate
