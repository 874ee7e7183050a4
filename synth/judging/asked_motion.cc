#include "synth/judging/asked_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr double kMoves = 1.0 / 3;  // of the fluid's mean speed
constexpr double kRises = 0.1;  // of what goes up and down: a fountain's rises by .21, one that falls by none

bool is_up(const cv::Vec2f& to) { return to[1] < -std::abs(to[0]); }

/// Of what was asked to go up and moves, enough rises.
bool rises(const cv::Mat& moves, const cv::Mat& asked, const cv::Mat& counted) {
  int up = 0, rising = 0;
  for (int y = 0; y < moves.rows; ++y)
    for (int x = 0; x < moves.cols; ++x)
      if (counted.at<std::uint8_t>(y, x) != 0 && is_up(asked.at<cv::Vec2f>(y, x))) {
        ++up;
        rising += moves.at<cv::Vec2f>(y, x)[1] < 0 ? 1 : 0;
      }
  return rising > kRises * up;
}

}  // namespace

Reading motion_angle(const Evidence& film, const FilmMotion& motion, const Asked& asked,
                     std::string_view kind) {
  if (asked.direction.empty()) return {};
  cv::Mat direction;
  cv::resize(asked.direction, direction, film.size(), 0, 0, cv::INTER_AREA);
  const double least = kMoves * cv::mean(motion.speed, film.fluid())[0];
  cv::Mat degrees = cv::Mat::zeros(film.size(), CV_32F), counted = cv::Mat::zeros(film.size(), CV_8U);
  for (int y = 0; y < degrees.rows; ++y)
    for (int x = 0; x < degrees.cols; ++x)
      if (film.fluid().at<std::uint8_t>(y, x) != 0 && cv::norm(direction.at<cv::Vec2f>(y, x)) > 0.1 &&
          cv::norm(motion.mean.at<cv::Vec2f>(y, x)) >= least)
        counted.at<std::uint8_t>(y, x) = 255;
  if (cv::countNonZero(counted) == 0) return {};
  const bool comes_down = kind == "water" && rises(motion.mean, direction, counted);
  for (int y = 0; y < degrees.rows; ++y)
    for (int x = 0; x < degrees.cols; ++x) {
      if (counted.at<std::uint8_t>(y, x) == 0) continue;
      const cv::Vec2f moves = motion.mean.at<cv::Vec2f>(y, x), to = direction.at<cv::Vec2f>(y, x);
      const double across = std::abs(moves[0] * to[1] - moves[1] * to[0]), along = moves.dot(to);
      const double angle = std::atan2(across, comes_down && is_up(to) ? std::abs(along) : along);
      degrees.at<float>(y, x) = static_cast<float>(angle * 180 / std::numbers::pi);
    }
  return {.value = cv::mean(degrees, counted)[0], .map = {cell_means(degrees, counted)}};
}

Reading speed_ratio(const Evidence& film, const FilmMotion& motion, const Asked& asked) {
  if (asked.speed.empty()) return {};
  const double enlarged = static_cast<double>(film.picture().width) / film.size().width;
  cv::Mat speed;
  cv::resize(asked.speed, speed, film.size(), 0, 0, cv::INTER_NEAREST);
  double wanted = 0, shown = 0;
  for (int y = 0; y < speed.rows; ++y)
    for (int x = 0; x < speed.cols; ++x)
      if (film.fluid().at<std::uint8_t>(y, x) != 0 && speed.at<float>(y, x) > 0) {
        wanted += speed.at<float>(y, x);
        shown += enlarged * cv::norm(motion.mean.at<cv::Vec2f>(y, x));
      }
  if (wanted <= 0) return {};
  return {.value = std::abs(std::log2(std::max(shown, 1e-3) / wanted)), .map = {}};
}

Reading mean_speed(const Evidence& film, const FilmMotion& motion) {
  const double enlarged = static_cast<double>(film.picture().width) / film.size().width;
  return {.value = enlarged * cv::mean(motion.speed, film.fluid())[0],
          .map = {cell_means(enlarged * motion.speed, film.matte())}};
}

}  // namespace freshet::synth::judging
