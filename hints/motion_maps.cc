#include "hints/motion_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture.h"

namespace freshet::hints {
namespace {

constexpr float kFull = 65535;
constexpr float kMinSaturation = 0.25f, kMinValue = 0.1f;

media::DeepPicture read_map(const std::filesystem::path& path, cv::Size picture, const char* what) {
  media::DeepPicture read = media::read_deep_picture(path);
  if (read.values.size() != picture)
    throw Error(ErrorKind::kInput, path.string(),
                fmt::format("the {} is {} x {}, the picture {} x {}", what, read.values.cols,
                            read.values.rows, picture.width, picture.height),
                "Make them equal in size");
  return read;
}

void take_notices(const std::vector<std::string>& from, std::vector<std::string>* to) {
  if (to != nullptr) to->insert(to->end(), from.begin(), from.end());
}

void check_white(double white_px_per_s) {
  if (!(white_px_per_s > 0) || !std::isfinite(white_px_per_s))
    throw Error(ErrorKind::kUsage, "speed of white", fmt::format("{} px/s is not above 0", white_px_per_s));
}

// Hue in degrees of a colour that is not grey.
float hue_of(float blue, float green, float red, float maximum, float chroma) {
  if (maximum == red) return 60 * (green - blue) / chroma;
  if (maximum == green) return 60 * (blue - red) / chroma + 120;
  return 60 * (red - green) / chroma + 240;
}

}  // namespace

cv::Mat read_speed_map(const std::filesystem::path& path, cv::Size picture, double white_px_per_s,
                       std::vector<std::string>* notices) {
  check_white(white_px_per_s);
  const media::DeepPicture read = read_map(path, picture, "speed map");
  take_notices(read.notices, notices);
  if (!read.grey && notices != nullptr) notices->emplace_back("colour reduced to grey");
  cv::Mat speed(picture, CV_32F);
  bool asked = false;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto& value = read.values.at<cv::Vec<std::uint16_t, 4>>(y, x);
      const float grey = read.grey
                             ? static_cast<float>(value[1])
                             : 0.114f * static_cast<float>(value[0]) + 0.587f * static_cast<float>(value[1]) +
                                   0.299f * static_cast<float>(value[2]);
      const bool here = value[3] > 32767;
      asked = asked || here;
      speed.at<float>(y, x) = here ? grey / kFull * static_cast<float>(white_px_per_s) : -1;
    }
  if (!asked)
    throw Error(ErrorKind::kInput, path.string(),
                "the speed map is transparent everywhere, so it asks nothing", "Paint it, or leave it out");
  return speed;
}

cv::Mat read_orientation_map(const std::filesystem::path& path, cv::Size picture,
                             std::vector<std::string>* notices) {
  const media::DeepPicture read = read_map(path, picture, "orientation map");
  take_notices(read.notices, notices);
  cv::Mat direction(picture, CV_32FC2);
  bool asked = false;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto& value = read.values.at<cv::Vec<std::uint16_t, 4>>(y, x);
      const auto blue = static_cast<float>(value[0]), green = static_cast<float>(value[1]),
                 red = static_cast<float>(value[2]);
      const float maximum = std::max({blue, green, red}), chroma = maximum - std::min({blue, green, red});
      cv::Vec2f& way = direction.at<cv::Vec2f>(y, x);
      way = {0, 0};
      if (value[3] <= 32767 || maximum < kMinValue * kFull || chroma < kMinSaturation * maximum) continue;
      const float angle = hue_of(blue, green, red, maximum, chroma) * std::numbers::pi_v<float> / 180;
      way = {std::cos(angle), -std::sin(angle)};
      asked = true;
    }
  if (!asked)
    throw Error(ErrorKind::kInput, path.string(),
                "the orientation map has no colour anywhere, so it asks nothing",
                "Paint directions as hues: 0 (red) right, 90 up, 180 (cyan) left, 270 down");
  return direction;
}

void split_motion(const cv::Mat& motion, const cv::Mat& matte, cv::Mat& direction, cv::Mat& speed) {
  direction.create(motion.size(), CV_32FC2);
  speed.create(motion.size(), CV_32F);
  for (int y = 0; y < motion.rows; ++y)
    for (int x = 0; x < motion.cols; ++x) {
      const cv::Vec2f& way = motion.at<cv::Vec2f>(y, x);
      const float length = matte.at<std::uint8_t>(y, x) > 0 ? std::hypot(way[0], way[1]) : 0;
      speed.at<float>(y, x) = length > 0 ? length : -1;
      direction.at<cv::Vec2f>(y, x) = length < kMinDirectedSpeed ? cv::Vec2f(0, 0) : way / length;
    }
}

cv::Vec3f colour_of_direction(const cv::Vec2f& way) {
  float hue = std::atan2(-way[1], way[0]) * 180 / std::numbers::pi_v<float>;
  if (hue < 0) hue += 360;
  // Each channel rises, stays and falls over the wheel's six parts.
  const auto channel = [&](float shift) {
    float at = std::fmod(hue / 60 + shift, 6.0f);
    return std::clamp(std::min(at, 4 - at), 0.0f, 1.0f);
  };
  return {channel(4), channel(0), channel(2)};
}

double write_speed_map(const std::filesystem::path& path, const cv::Mat& motion, const cv::Mat& matte,
                       double white_px_per_s) {
  check_white(white_px_per_s);
  check_map_name(path);
  cv::Mat direction, speed, map(motion.size(), CV_16UC4, cv::Scalar::all(0));
  split_motion(motion, matte, direction, speed);
  std::size_t moving = 0, cut = 0;
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      if (speed.at<float>(y, x) < 0) continue;
      const double fraction = speed.at<float>(y, x) / white_px_per_s;
      ++moving;
      cut += fraction > 1;
      const auto grey = cv::saturate_cast<std::uint16_t>(fraction * kFull);
      map.at<cv::Vec<std::uint16_t, 4>>(y, x) = {grey, grey, grey, 65535};
    }
  media::write_picture(path, map);
  return moving > 0 ? static_cast<double>(cut) / static_cast<double>(moving) : 0;
}

void write_orientation_map(const std::filesystem::path& path, const cv::Mat& motion, const cv::Mat& matte) {
  check_map_name(path);
  cv::Mat direction, speed, map(motion.size(), CV_16UC3, cv::Scalar::all(32768));
  split_motion(motion, matte, direction, speed);
  for (int y = 0; y < map.rows; ++y)
    for (int x = 0; x < map.cols; ++x) {
      const cv::Vec2f& way = direction.at<cv::Vec2f>(y, x);
      if (way == cv::Vec2f(0, 0)) continue;
      const cv::Vec3f colour = colour_of_direction(way) * kFull;
      map.at<cv::Vec<std::uint16_t, 3>>(y, x) = {cv::saturate_cast<std::uint16_t>(colour[0]),
                                                 cv::saturate_cast<std::uint16_t>(colour[1]),
                                                 cv::saturate_cast<std::uint16_t>(colour[2])};
    }
  media::write_picture(path, map);
}

void check_map_name(const std::filesystem::path& path) {
  const std::string ending = path.extension().string();
  if (ending != ".png" && ending != ".tif" && ending != ".tiff")
    throw Error(ErrorKind::kUsage, path.string(), "a map needs a format that keeps 16 bits",
                "Use .png or .tif");
  media::check_picture_name(path);
}

}  // namespace freshet::hints
