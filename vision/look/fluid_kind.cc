#include "vision/look/fluid_kind.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

constexpr double kSide = 256;  // px

// By reading: how much it speaks for water, fire, smoke, clouds. The eight clips that set no constant are not in it.
struct Reading {
  const char* name;
  std::array<float, kFluidKinds.size()> weights;
};
constexpr std::array<Reading, kLookReadings> kReadings{{
    {"luma_mean", {-0.05407f, -2.321f, -1.029f, 3.167f}},
    {"luma_spread", {-1.14f, 0.6038f, 0.693f, 0.5178f}},
    {"blue_mean", {-0.6146f, -2.78f, -0.8551f, 4.337f}},
    {"blue_spread", {-3.2f, 3.457f, 0.6545f, 0.2345f}},
    {"red_mean", {-4.699f, 10.78f, -2.495f, -3.991f}},
    {"red_spread", {-4.266f, 16.58f, -3.564f, -10.33f}},
    {"luma_dark", {0.7717f, 0.1769f, -0.6732f, -0.8781f}},
    {"luma_bright", {0.2547f, -0.8498f, -0.5546f, 0.8823f}},
    {"warm_share", {-2.127f, 6.605f, -1.091f, -3.709f}},
    {"chroma", {-1.209f, 3.597f, -2.298f, -1.022f}},
    {"detail_1", {1.243f, -0.2386f, -1.099f, -0.8356f}},
    {"detail_2", {0.2512f, 0.6548f, -0.8921f, -0.5703f}},
    {"detail_4", {-0.2875f, 0.4665f, -0.3224f, 0.059f}},
    {"detail_8", {-0.2193f, -0.5207f, 0.3547f, 0.6736f}},
    {"upright", {-0.4609f, 0.5239f, 0.5657f, -0.2516f}},
    {"slanted", {0.768f, 1.297f, -2.365f, -1.173f}},
    {"height", {1.055f, -0.8283f, -1.101f, 0.06545f}},
    {"height_spread", {2.833f, -4.816f, -0.9074f, 1.887f}},
    {"aspect", {0.4748f, -0.2477f, -1.309f, 0.3364f}},
    {"share", {0.4189f, -0.5274f, 0.058f, -0.02747f}},
    {"share_bottom", {0.4336f, 0.2139f, -0.2391f, -0.6942f}},
    {"share_top", {-0.2228f, -0.2804f, 0.4128f, 0.3846f}},
    {"against_rest", {-0.2203f, 0.7832f, -0.0985f, -0.5002f}},
    {"red_on_luma", {0.7321f, -1.245f, -0.9947f, 0.9019f}},
    {"blue_on_luma", {0.366f, 0.2207f, 0.2916f, -0.8989f}},
}};
constexpr std::array<float, kFluidKinds.size()> kOffsets{2.7125f, -1.0314f, -6.2799f, -5.3728f};

struct Spread {
  double mean = 0, deviation = 0;
};
Spread spread(const cv::Mat& plane, const cv::Mat& inside) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(plane, mean, deviation, inside);
  return {mean[0], deviation[0]};
}

/// Sum of products inside, less that of the means, by pixel.
double covariance(const cv::Mat& a, const cv::Mat& b, const cv::Mat& inside) {
  return cv::mean(a.mul(b), inside)[0] - cv::mean(a, inside)[0] * cv::mean(b, inside)[0];
}

/// Where the fluid lies: mean row, deviations of rows and columns, px.
struct Place {
  double row = 0, rows = 0, columns = 0;
};
Place place_of(const cv::Mat& inside) {
  const cv::Moments m = cv::moments(inside, true);
  return {m.m01 / m.m00, std::sqrt(m.mu02 / m.m00), std::sqrt(m.mu20 / m.m00)};
}

}  // namespace

const char* look_name(std::size_t reading) { return kReadings.at(reading).name; }

std::array<float, kLookReadings> fluid_look(const cv::Mat& picture, const cv::Mat& matte) {
  assert(picture.type() == CV_8UC3 && matte.type() == CV_8U && picture.size() == matte.size());
  const double scale = kSide / std::max(picture.cols, picture.rows);
  cv::Mat small, alpha;
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  cv::resize(matte, alpha, size, 0, 0, cv::INTER_AREA);
  cv::Mat inside = alpha > 127;
  if (cv::countNonZero(inside) == 0) inside = alpha > 0;  // a thread of fluid
  if (cv::countNonZero(inside) == 0) inside.setTo(255);

  small.convertTo(small, CV_32F, 1 / 255.);
  std::array<cv::Mat, 3> bgr;
  cv::split(small, bgr.data());
  const cv::Mat luma = .114 * bgr[0] + .587 * bgr[1] + .299 * bgr[2];
  const cv::Mat blue = bgr[0] - luma, red = bgr[2] - luma;
  std::array<float, kLookReadings> look{};
  std::size_t next = 0;
  const auto put = [&](double reading) { look[next++] = static_cast<float>(reading); };

  for (const cv::Mat& plane : {luma, blue, red}) {
    const Spread s = spread(plane, inside);
    put(s.mean);
    put(s.deviation);
  }
  std::vector<float> lumas;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      if (inside.at<std::uint8_t>(y, x) != 0) lumas.push_back(luma.at<float>(y, x));
  std::ranges::sort(lumas);
  for (const double part : {.05, .95})
    put(lumas[static_cast<std::size_t>(part * static_cast<double>(lumas.size() - 1))]);
  const cv::Mat warm = (red > .15) & (bgr[2] > .5);
  put(cv::mean(warm, inside)[0] / 255);
  cv::Mat chroma;
  cv::magnitude(blue, red, chroma);
  put(cv::mean(chroma, inside)[0]);

  // Contrast of each size of detail.
  cv::Mat finer = luma;
  for (const double sigma : {1., 2., 4., 8.}) {
    cv::Mat blurred;
    cv::GaussianBlur(luma, blurred, {}, sigma);
    const cv::Mat band = finer - blurred;
    put(std::log(std::sqrt(cv::mean(band.mul(band), inside)[0]) + .002));
    finer = blurred;
  }
  // Edges: 1 where all stand upright, -1 where all lie; and how they slant.
  cv::Mat blurred, across, down;
  cv::GaussianBlur(luma, blurred, {}, 1);
  cv::Sobel(blurred, across, CV_32F, 1, 0, 3, 1 / 8.);
  cv::Sobel(blurred, down, CV_32F, 0, 1, 3, 1 / 8.);
  const double pixels = static_cast<double>(lumas.size());
  const double xx = cv::mean(across.mul(across), inside)[0] * pixels,
               yy = cv::mean(down.mul(down), inside)[0] * pixels,
               xy = cv::mean(across.mul(down), inside)[0] * pixels;
  put((xx - yy) / (xx + yy + 1e-6));
  put(2 * xy / (xx + yy + 1e-6));

  const Place place = place_of(inside);
  put(place.row / size.height - .5);
  put(place.rows / size.height);
  put(std::log((place.columns + 1) / (place.rows + 1)));
  put(pixels / static_cast<double>(size.area()));
  const int edge = std::min(2, size.height);
  put(cv::mean(inside.rowRange(size.height - edge, size.height))[0] / 255);
  put(cv::mean(inside.rowRange(0, edge))[0] / 255);
  const cv::Mat rest = ~inside;
  const double around = cv::countNonZero(rest) > 0 ? cv::mean(luma, rest)[0] : cv::mean(luma)[0];
  put(std::log((cv::mean(luma, inside)[0] + .02) / (around + .02)));

  // A flame turns from red to yellow as it gets brighter.
  const double variance = std::pow(spread(luma, inside).deviation, 2) + 1e-4;
  put(covariance(luma, red, inside) / variance);
  put(covariance(luma, blue, inside) / variance);
  assert(next == look.size());
  return look;
}

FluidKind fluid_kind(const std::array<float, kLookReadings>& look) {
  std::array<double, kFluidKinds.size()> score{};
  for (std::size_t kind = 0; kind < score.size(); ++kind) {
    score[kind] = kOffsets[kind];
    for (std::size_t i = 0; i < look.size(); ++i) score[kind] += double{look[i]} * kReadings[i].weights[kind];
  }
  const auto best = std::ranges::max_element(score);
  FluidKind kind{.best = static_cast<int>(best - score.begin())};
  double sum = 0;
  for (std::size_t k = 0; k < score.size(); ++k) sum += kind.share[k] = std::exp(score[k] - *best);
  for (double& share : kind.share) share /= sum;
  return kind;
}

}  // namespace freshet::vision
