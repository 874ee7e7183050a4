#include "bench/kind/outlines.h"

#include <charconv>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/video/video_reader.h"
#include "synth/simulate/simulate.h"

namespace freshet::bench {
namespace {

std::vector<std::string> parted(const std::string& text, char by) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, by);) parts.push_back(part);
  return parts;
}

double percent(const std::string& text) {
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size() || value < 0 || value > 100)
    throw std::invalid_argument("\"" + text + "\" is no number from 0 to 100");
  return value;
}

std::vector<cv::Point2d> outline(const std::string& text) {
  std::vector<cv::Point2d> points;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::vector<std::string> xy = parted(word, ',');
    if (xy.size() != 2) throw std::invalid_argument("\"" + word + "\" is no x,y");
    points.emplace_back(percent(xy[0]) / 100, percent(xy[1]) / 100);
  }
  if (points.size() < 3) throw std::invalid_argument("an outline has three points or more");
  return points;
}

Outlined outlined(const std::string& line) {
  std::istringstream words(line);
  std::string classes, file, outlines;
  Outlined one;
  if (!(words >> classes >> one.motion >> file) || !std::getline(words >> std::ws, outlines))
    throw std::invalid_argument("class, motion, file and outlines are expected");
  one.classes = parted(classes, '/');
  const std::size_t at = file.find('@');
  one.file = file.substr(0, at);
  for (const std::string& frame : parted(at == std::string::npos ? "15,50,85" : file.substr(at + 1), ','))
    one.percents.push_back(static_cast<int>(percent(frame)));
  if (outlines != "all" && outlines != "alpha")
    for (const std::string& part : parted(outlines, ';')) one.outlines.push_back(outline(part));
  return one;
}

cv::Mat within(const cv::Mat& still, int side) {
  const double scale = 1.0 * side / std::max(still.cols, still.rows);
  if (scale >= 1) return still;
  cv::Mat small;
  cv::resize(still, small, {}, scale, scale, cv::INTER_AREA);
  return small;
}

/// Of simulated/CLIP/SEED.
Still simulated(const Outlined& outlined) {
  const std::vector<std::string> words = parted(outlined.file, '/');
  if (words.size() != 3) throw Error(ErrorKind::kInput, outlined.file, "simulated/CLIP/SEED is expected");
  synth::simulate::Simulation clip({.kind = synth::simulate::parse_scene_kind(words[1]),
                                    .size = {320, 240},
                                    .frames = 1,
                                    .seed = static_cast<std::uint64_t>(percent(words[2]))});
  synth::simulate::SimulatedFrame frame;
  clip.next(frame);
  return {frame.picture, frame.alpha};
}

}  // namespace

cv::Mat Outlined::matte(cv::Size size) const {
  if (outlines.empty()) return {size, CV_8U, cv::Scalar(255)};
  std::vector<std::vector<cv::Point>> polygons;
  for (const std::vector<cv::Point2d>& points : outlines) {
    std::vector<cv::Point>& polygon = polygons.emplace_back();
    for (const cv::Point2d& point : points)
      polygon.emplace_back(cvRound(point.x * size.width), cvRound(point.y * size.height));
  }
  cv::Mat matte(size, CV_8U, cv::Scalar(0));
  cv::fillPoly(matte, polygons, 255);
  return matte;
}

std::vector<Outlined> read_outlines(const std::filesystem::path& path) {
  std::ifstream stream(path);
  if (!stream) throw Error(ErrorKind::kInput, path.string(), "cannot be read");
  std::vector<Outlined> all;
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (const std::size_t first = line.find_first_not_of(" \t");
        first == std::string::npos || line[first] == '#')
      continue;
    try {
      all.push_back(outlined(line));
    } catch (const std::invalid_argument& fault) {
      throw Error(ErrorKind::kInput, fmt::format("{}, line {}", path.string(), number), fault.what());
    }
  }
  return all;
}

std::vector<Still> stills_of(const Outlined& outlined, const std::filesystem::path& footage, int side) {
  if (outlined.simulated()) return {simulated(outlined)};
  const auto still = [&](const cv::Mat& picture) { return Still{picture, outlined.matte(picture.size())}; };
  const std::filesystem::path path = footage / outlined.file;
  if (media::looks_like_picture(path)) return {still(within(media::read_picture(path).bgr, side))};
  std::vector<cv::Mat> frames;
  media::VideoReader reader(path, 1, {.upright = true});
  while (const auto frame = reader.next()) frames.push_back(within(media::to_bgr(*frame), side));
  std::vector<Still> stills;
  for (const int percent : outlined.percents)
    stills.push_back(
        still(frames[std::min(frames.size() - 1, frames.size() * static_cast<std::size_t>(percent) / 100)]));
  return stills;
}

}  // namespace freshet::bench
