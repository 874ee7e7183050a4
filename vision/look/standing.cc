#include "vision/look/standing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

#include <opencv2/imgproc.hpp>

#include "vision/look/lab_colours.h"
#include "vision/look/round_things.h"
#include "vision/look/standing_weights.h"

namespace freshet::vision {
namespace {

constexpr float kNear = 20;  // px

constexpr int kDeepestFrame = 10;      // px
constexpr double kFrameStep = 2;       // Lab: the median step along a side
constexpr double kFrameStandsOut = 2;  // times the greatest such step farther in

constexpr double kMostHeld = .1;  // of the matte

consteval bool names_match() {
  for (std::size_t i = 0; i < kStandingFigures.size(); ++i)
    if (kStandingWeights.at(i).figure != kStandingFigures.at(i)) return false;
  return kStandingWeights.size() == kStandingFigures.size();
}
static_assert(names_match(), "the figures changed: learn standing_weights.h again (holds.py --weights)");

cv::Mat channel(const cv::Mat& lab, int of) {
  cv::Mat plane;
  cv::extractChannel(lab, plane, of);
  return plane;
}

cv::Mat decay(const cv::Mat& distance, float length) {
  cv::Mat out;
  cv::exp(distance * (-1 / length), out);
  return out;
}

/// Mean colour of what is so weighed, within sigma px.
cv::Mat colour_around(const cv::Mat& lab, const cv::Mat& weight, double sigma) {
  const cv::Mat spread = gaussian(weight, sigma) + 1e-4;
  cv::Mat weights, spreads, out;
  cv::merge(std::vector{weight, weight, weight}, weights);
  cv::merge(std::vector{spread, spread, spread}, spreads);
  cv::divide(gaussian(lab.mul(weights), sigma), spreads, out);
  return out;
}

cv::Mat length(const cv::Mat& lab) {
  cv::Mat planes = lab.mul(lab), out;
  cv::transform(planes, out, cv::Matx13f(1, 1, 1));
  cv::sqrt(out, out);
  return out;
}

/// From the fluid's 2nd to its 98th row of hundred, by pixels.
std::pair<int, int> rows_of(const cv::Mat& inside) {
  const int all = cv::countNonZero(inside);
  int from = 0, to = inside.rows - 1;
  for (int seen = 0; from < to; ++from)
    if ((seen += cv::countNonZero(inside.row(from))) > all / 50) break;
  for (int seen = 0; to > from; --to)
    if ((seen += cv::countNonZero(inside.row(to))) > all / 50) break;
  return {from, to};
}

/// How far the frame goes in from the upper side; 0 without one.
int frame_depth(const cv::Mat& lab) {
  if (lab.rows < 4 * kDeepestFrame) return 0;
  std::vector<double> steps;  // from row i to i + 1
  for (int y = 0; y + 1 < 2 * kDeepestFrame + 4; ++y) {
    const cv::Mat step = lab.row(y + 1) - lab.row(y), all(step.size(), CV_8U, cv::Scalar(255));
    double squared = 0;
    for (int of = 0; of < 3; ++of) squared += std::pow(median(channel(step, of), all), 2);
    steps.push_back(std::sqrt(squared));
  }
  const double farther = *std::max_element(steps.begin() + kDeepestFrame + 2, steps.end());
  for (int y = kDeepestFrame; y-- > 0;)
    if (steps[static_cast<std::size_t>(y)] > std::max(kFrameStep, kFrameStandsOut * farther)) return y + 1;
  return 0;
}

}  // namespace

std::vector<cv::Mat> standing_figures(const cv::Mat& picture, const cv::Mat& matte) {
  assert(picture.type() == CV_8UC3 && matte.type() == CV_8U && picture.size() == matte.size());
  cv::Mat small;
  cv::resize(picture, small, worked_size(picture.size()), 0, 0, cv::INTER_AREA);
  const cv::Mat inside = worked_matte(matte);
  const cv::Mat lab = lab_of(gaussian(small, 1.2)), luma = channel(lab, 0), smooth = gaussian(lab, 1.5);
  cv::Mat fluid, distance;
  inside.convertTo(fluid, CV_32F, 1 / 255.);
  const cv::Mat beside = 1 - fluid;
  cv::distanceTransform(inside, distance, cv::DIST_L2, 5);
  const cv::Mat near = decay(distance, kNear);

  std::vector<cv::Mat> figures;
  const cv::Mat share = gaussian(beside, 12);
  figures.push_back(share);
  figures.push_back(decay(distance, 5));

  const cv::Mat ratio = log_ratio_beside(lab, inside), background = gaussian(ratio, 2),
                likely = cv::max(gaussian(cv::max(cv::min(ratio, 4), -4), 2), 0);
  figures.push_back(background);

  const cv::Mat off_fluid = length(smooth - colour_around(lab, fluid, 12)),
                off_beside = length(smooth - colour_around(lab, beside, 12));
  const cv::Mat nearer = cv::max(cv::min((off_fluid - off_beside) / 20, 2), -2);
  figures.push_back(nearer.mul(cv::min(4 * share, 1)));

  const cv::Mat band = luma - gaussian(luma, 2);
  cv::Mat detail;
  cv::log(gaussian(band.mul(band), 3) + .05, detail);
  figures.push_back(detail - median(detail, inside));

  const auto [from, to] = rows_of(inside);
  cv::Mat height(inside.size(), CV_32F);
  for (int y = 0; y < height.rows; ++y)
    height.row(y).setTo(static_cast<float>(y - from) / static_cast<float>(std::max(1, to - from)) - .5f);
  figures.push_back(height);

  const float spread = robust_deviation(luma, median(luma, inside), inside);
  const cv::Mat darker = (channel(colour_around(lab, fluid, 35), 0) - channel(smooth, 0)) / spread;
  figures.push_back(darker.mul(near));
  figures.push_back(off_fluid.mul(near, 1 / 20.));
  figures.push_back(likely.mul(near));

  std::array<cv::Mat, 2> off;
  for (int of = 0; of < 2; ++of) {
    const cv::Mat plane = channel(lab, of + 1);
    const float middle = median(plane, inside);
    off.at(static_cast<std::size_t>(of)) = (plane - middle) / robust_deviation(plane, middle, inside);
  }
  cv::Mat hue;
  cv::magnitude(off[0], off[1], hue);
  figures.push_back(hue.mul(near));
  assert(figures.size() == kStandingFigures.size());
  return figures;
}

cv::Mat own_frame(const cv::Mat& picture) {
  assert(picture.type() == CV_8UC3);
  cv::Mat small;
  cv::resize(picture, small, worked_size(picture.size()), 0, 0, cv::INTER_AREA);
  cv::Mat side = lab_of(small), frame(small.size(), CV_8U, cv::Scalar(0));
  for (int turns = 0; turns < 4; ++turns) {
    if (const int depth = frame_depth(side)) frame.rowRange(0, depth).setTo(255);
    cv::rotate(side, side, cv::ROTATE_90_CLOCKWISE);
    cv::rotate(frame, frame, cv::ROTATE_90_CLOCKWISE);
  }
  cv::resize(frame, frame, picture.size(), 0, 0, cv::INTER_LINEAR);
  return frame;
}

cv::Mat what_stands(const cv::Mat& picture, const cv::Mat& matte) {
  assert(picture.type() == CV_8UC3 && matte.type() == CV_8U && picture.size() == matte.size());
  const cv::Mat inside = matte > 127;
  cv::Mat stands = own_frame(picture);
  stands.setTo(0, ~inside);
  if (cv::countNonZero(inside) == 0) return stands;
  const std::vector<cv::Mat> figures = standing_figures(picture, matte);
  cv::Mat score(figures[0].size(), CV_32F, cv::Scalar(kStandingOffset));
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const StandingWeight& w = kStandingWeights.at(i);
    score += w.speaks_for *
             cv::max(cv::min((figures[i] - w.mean) / w.deviation, kFarthestFigure), -kFarthestFigure);
  }
  cv::Mat here;
  cv::resize(inside, here, score.size(), 0, 0, cv::INTER_AREA);
  here = here > 127;
  // No more than a tenth: the scores that nine tenths lie below.
  std::vector<float> scores;
  for (int y = 0; y < score.rows; ++y)
    for (int x = 0; x < score.cols; ++x)
      if (here.at<uchar>(y, x)) scores.push_back(score.at<float>(y, x));
  double least = kLeastScore;
  if (!scores.empty()) {
    const auto tenth =
        scores.begin() + static_cast<std::ptrdiff_t>(kMostHeld * static_cast<double>(scores.size()));
    std::ranges::nth_element(scores, tenth, std::greater{});
    least = std::max<double>(least, *tenth);
  }
  cv::Mat found = (score > least) & here;
  cv::medianBlur(found, found, 5);  // no specks
  cv::resize(found, found, picture.size(), 0, 0, cv::INTER_LINEAR);
  cv::GaussianBlur(found, found, {}, .8);
  found = cv::max(found, round_things(picture, matte));
  found.setTo(0, ~inside);
  return cv::max(stands, found);
}

}  // namespace freshet::vision
