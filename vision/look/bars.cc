#include "vision/look/bars.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "vision/look/lab_colours.h"

namespace freshet::vision {
namespace {

// Of 8-bit levels: the lightest black, and how far apart one black is (coarse JPEG).
constexpr int kBlack = 24, kOneBlack = 4;
// Of a row: how much of it is black in a bar, and how much of the first of the picture is not. Of 46 clips and 23
// pictures with black beside a flame or smoke the most was .67 (.96 beside a candle that has a bar), of a letterboxed
// film all.
constexpr double kAllBlack = 0.995, kMostEnds = 0.8;
constexpr int kLeast_px = 2;  // of worked_size: narrower is no bar
// Where bar and picture are mixed: over so much at most, and darker than this share of what follows.
constexpr int kMixed_px = 6;
constexpr double kMixed = 0.6;

double share_of(const cv::Mat& mask) {
  return static_cast<double>(cv::countNonZero(mask)) / static_cast<double>(mask.total());
}

/// How many rows from the upper side inwards are no picture. light: CV_8U, of the brightest channel.
int depth(const cv::Mat& light) {
  std::vector<std::uint8_t> first(light.ptr(0), light.ptr(0) + light.cols);
  const auto middle = first.begin() + light.cols / 2;
  std::nth_element(first.begin(), middle, first.end());
  const int black = *middle, half = light.rows / 2;
  if (black > kBlack) return 0;
  const auto in_bar = [&](int y) {
    return share_of((light.row(y) >= black - kOneBlack) & (light.row(y) <= black + kOneBlack)) >= kAllBlack;
  };
  int rows = 0;
  while (rows < half && in_bar(rows)) ++rows;
  if (rows < kLeast_px || rows + kMixed_px >= half) return 0;
  const auto above_black = [&](int y) { return cv::mean(light.row(y))[0] - black; };
  const int last = rows + kMixed_px;
  while (rows < last && above_black(rows) < kMixed * above_black(last)) ++rows;
  return share_of(light.row(rows) > black + kOneBlack) < kMostEnds ? 0 : rows;
}

}  // namespace

cv::Rect within_bars(const cv::Mat& picture) {
  assert(picture.type() == CV_8UC3);
  cv::Mat small;
  // Never larger: bars would end between rows.
  const cv::Size worked = worked_size(picture.size());
  if (worked.width < picture.cols && worked.height < picture.rows)
    cv::resize(picture, small, worked, 0, 0, cv::INTER_AREA);
  else
    small = picture;
  std::array<cv::Mat, 3> channels;
  cv::split(small, channels.data());
  cv::Mat light = cv::max(cv::max(channels[0], channels[1]), channels[2]);
  std::array<int, 4> depths{};  // upper, left, lower, right
  for (int& of : depths) {
    of = depth(light);
    cv::rotate(light, light, cv::ROTATE_90_CLOCKWISE);
  }
  const double scale_x = static_cast<double>(picture.cols) / small.cols,
               scale_y = static_cast<double>(picture.rows) / small.rows;
  const auto cut = [](int of, double scale) { return static_cast<int>(std::ceil(of * scale)); };
  const int top = cut(depths[0], scale_y), left = cut(depths[1], scale_x);
  return {left, top, picture.cols - left - cut(depths[3], scale_x),
          picture.rows - top - cut(depths[2], scale_y)};
}

cv::Mat matte_within_bars(const cv::Mat& picture) {
  cv::Mat matte = cv::Mat::zeros(picture.size(), CV_8U);
  matte(within_bars(picture)).setTo(255);
  return matte;
}

}  // namespace freshet::vision
