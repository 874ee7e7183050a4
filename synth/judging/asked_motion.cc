#include "synth/judging/asked_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {
namespace {

constexpr double kMoves = 1.0 / 3;  // of the fluid's mean speed

}  // namespace

Reading motion_angle(const Evidence& film, const FilmMotion& motion, const Asked& asked, bool comes_down) {
  if (asked.direction.empty()) return {};
  cv::Mat direction;
  cv::resize(asked.direction, direction, film.size(), 0, 0, cv::INTER_AREA);
  const double least = kMoves * cv::mean(motion.speed, film.fluid())[0];
  cv::Mat degrees = cv::Mat::zeros(film.size(), CV_32F), counted = cv::Mat::zeros(film.size(), CV_8U);
  double sum = 0;
  int count = 0;
  for (int y = 0; y < degrees.rows; ++y)
    for (int x = 0; x < degrees.cols; ++x) {
      const cv::Vec2f moves = motion.mean.at<cv::Vec2f>(y, x), to = direction.at<cv::Vec2f>(y, x);
      if (film.fluid().at<std::uint8_t>(y, x) == 0 || !(cv::norm(to) > 0.1) || cv::norm(moves) < least)
        continue;
      const double along = moves.dot(to), across = std::abs(moves[0] * to[1] - moves[1] * to[0]);
      const bool either_way = comes_down && to[1] < -std::abs(to[0]);
      const double angle = std::atan2(across, either_way ? std::abs(along) : along);
      degrees.at<float>(y, x) = static_cast<float>(angle * 180 / std::numbers::pi);
      counted.at<std::uint8_t>(y, x) = 255;
      sum += degrees.at<float>(y, x);
      ++count;
    }
  if (count == 0) return {};
  return {.value = sum / count, .map = {cell_means(degrees, counted)}};
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
