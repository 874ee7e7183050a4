#include "vision/look/round_things.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "vision/look/lab_colours.h"

namespace freshet::vision {
namespace {

constexpr int kSmallest = 150;   // px
constexpr double kLargest = .1;  // of the matte
constexpr int kSteps = 8;        // of 255 that a region is stable over
constexpr double kVariation = .35, kDiversity = .3;
constexpr double kRound = .7;    // its area, of that of a disc with its hull's circumference
constexpr double kUnlike = 1.5;  // deviations of the fluid's colours, of their median

bool is_round(const std::vector<cv::Point>& region) {
  std::vector<cv::Point> hull;
  cv::convexHull(region, hull);
  return 4 * CV_PI * static_cast<double>(region.size()) > kRound * std::pow(cv::arcLength(hull, true), 2);
}

/// An 8-bit plane that MSER sees: of L 2.55 levels, of a and b 2 a unit.
cv::Mat levels(const cv::Mat& lab, int of) {
  cv::Mat plane;
  cv::extractChannel(lab, plane, of);
  plane.convertTo(plane, CV_8U, of == 0 ? 2.55 : 2, of == 0 ? 0 : 128);
  return plane;
}

}  // namespace

cv::Mat round_things(const cv::Mat& picture, const cv::Mat& matte) {
  assert(picture.type() == CV_8UC3 && matte.type() == CV_8U && picture.size() == matte.size());
  const cv::Mat inside = worked_matte(matte);
  cv::Mat small, found = cv::Mat::zeros(inside.size(), CV_8U), all = found.clone();
  const int area = cv::countNonZero(inside);
  if (std::min(inside.cols, inside.rows) >= 3 && area > kSmallest) {
    cv::resize(picture, small, inside.size(), 0, 0, cv::INTER_AREA);
    const cv::Mat lab = lab_of(gaussian(small, 1));
    std::array<cv::Mat, 3> planes;
    cv::split(lab, planes.data());
    std::array<double, 3> middle{}, spread{};
    for (std::size_t of = 0; of < 3; ++of) {
      const float median_of = median(planes.at(of), inside);
      middle.at(of) = median_of;
      spread.at(of) = robust_deviation(planes.at(of), median_of, inside);
    }
    const auto stable =
        cv::MSER::create(kSteps, kSmallest, kSmallest + cvRound(kLargest * area), kVariation, kDiversity);
    for (int of = 0; of < 3; ++of) {
      std::vector<std::vector<cv::Point>> regions;
      std::vector<cv::Rect> boxes;
      stable->detectRegions(levels(lab, of), regions, boxes);
      for (const std::vector<cv::Point>& region : regions) {
        if (!is_round(region)) continue;
        const cv::Rect box = cv::boundingRect(region);
        cv::Mat here = all(box);
        here.setTo(0);
        for (const cv::Point& point : region) all.at<uchar>(point) = 255;
        here &= inside(box);
        if (2 * cv::countNonZero(here) < static_cast<int>(region.size())) continue;
        const cv::Scalar own = cv::mean(lab(box), here);
        double unlike = 0;
        for (int i = 0; i < 3; ++i) {
          const auto at = static_cast<std::size_t>(i);
          unlike += std::pow((own[i] - middle.at(at)) / spread.at(at), 2);
        }
        if (unlike > kUnlike * kUnlike) found(box).setTo(255, here);
      }
    }
  }
  cv::resize(found, found, picture.size(), 0, 0, cv::INTER_LINEAR);
  cv::GaussianBlur(found, found, {}, .8);
  return found;
}

}  // namespace freshet::vision
