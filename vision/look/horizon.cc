#include "vision/look/horizon.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "vision/look/bars.h"
#include "vision/look/fluid_kind.h"
#include "vision/look/fluid_look.h"

namespace freshet::vision {
namespace {

constexpr float kWithin = 1;         // px of the line
constexpr double kLeastShare = 0.5;  // of the picture's width
constexpr float kSteepest = 0.07f;   // 4 degrees

/// The middles of the highest fluid pixels that something lies above, by column.
std::vector<cv::Point2f> upper_border(const cv::Mat& matte) {
  std::vector<cv::Point2f> border;
  for (int x = 0; x < matte.cols; ++x)
    for (int y = 0; y < matte.rows; ++y)
      if (matte.at<std::uint8_t>(y, x) > 127) {
        if (y > 0) border.emplace_back(static_cast<float>(x) + 0.5f, static_cast<float>(y));
        break;
      }
  return border;
}

int lying_on(const std::vector<cv::Point2f>& border, float height, float slope) {
  return static_cast<int>(std::count_if(border.begin(), border.end(), [&](const cv::Point2f& p) {
    return std::abs(p.y - (height + slope * p.x)) <= kWithin;
  }));
}

/// Whether it is where the upper of two black bars ends. A black sky alone is none.
bool ends_at_a_bar(const Horizon& horizon, const cv::Mat& picture) {
  const cv::Rect seen = within_bars(picture);
  return seen.y > 0 && seen.br().y < picture.rows &&
         std::max(horizon.from.y, horizon.to.y) <= static_cast<float>(seen.y) + kWithin;
}

}  // namespace

std::optional<Horizon> horizon_of(const cv::Mat& matte) {
  const std::vector<cv::Point2f> border = upper_border(matte);
  const auto least = static_cast<std::size_t>(kLeastShare * matte.cols);
  if (border.size() < std::max<std::size_t>(least, 2)) return std::nullopt;
  // Through pairs of columns that lie a quarter of the border and more apart: a few thousand lines, all tried.
  const std::size_t step = std::max<std::size_t>(border.size() / 64, 1);
  int most = 0;
  float height = 0, slope = 0;
  for (std::size_t i = 0; i < border.size(); i += step)
    for (std::size_t j = i + border.size() / 4; j < border.size(); j += step) {
      if (i == j) continue;
      const float tried = (border[j].y - border[i].y) / (border[j].x - border[i].x);
      if (std::abs(tried) > kSteepest) continue;
      const float from = border[i].y - tried * border[i].x;
      const int on = lying_on(border, from, tried);
      if (on > most) most = on, height = from, slope = tried;
    }
  if (most < static_cast<int>(least)) return std::nullopt;
  const auto right = static_cast<float>(matte.cols);
  return Horizon{{0, height}, {right, height + slope * right}};
}

std::optional<Horizon> horizon_of_water(const cv::Mat& picture, const cv::Mat& matte,
                                        std::string_view class_name) {
  const std::optional<Horizon> found = horizon_of(matte);
  if (!found || ends_at_a_bar(*found, picture)) return {};
  const bool known = std::ranges::find(kFluidKinds, class_name) != kFluidKinds.end();
  const std::string_view kind = known ? class_name : fluid_kind(fluid_look(picture, matte)).name();
  return kind == "water" ? found : std::nullopt;
}

float below(const Horizon& horizon, cv::Point2f place) {
  const cv::Point2f along = horizon.to - horizon.from;
  return place.y - (horizon.from.y + along.y * (place.x - horizon.from.x) / along.x);
}

float seen_speed(const Horizon& horizon, cv::Point2f place, cv::Vec2f way, cv::Size picture) {
  const float distance = below(horizon, place);
  if (distance <= 0) return 0;
  const cv::Point2f line = horizon.to - horizon.from;
  const float length = std::hypot(line.x, line.y);
  float along = (way[0] * line.x + way[1] * line.y) / length,
        down = (way[1] * line.x - way[0] * line.y) / length;
  if (along == 0 && down == 0) along = 1;
  down *= static_cast<float>(picture.width) / distance;
  return distance / std::hypot(along, down);
}

cv::Mat seen_speeds(const Horizon& horizon, const cv::Mat& direction, cv::Size picture) {
  cv::Mat seen(picture, CV_32F);
  for (int y = 0; y < seen.rows; ++y)
    for (int x = 0; x < seen.cols; ++x)
      seen.at<float>(y, x) =
          seen_speed(horizon, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f},
                     direction.empty() ? cv::Vec2f(0, 0) : direction.at<cv::Vec2f>(y, x), picture);
  return seen;
}

}  // namespace freshet::vision
