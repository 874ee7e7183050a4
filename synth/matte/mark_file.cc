#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/text_file.h"
#include "synth/matte/marks.h"

namespace freshet::synth::matte {
namespace {

using Json = nlohmann::json;

constexpr std::uintmax_t kMaxBytes = 16u << 20;
constexpr std::size_t kMaxMarks = 10000, kMaxPoints = 1u << 20;
constexpr double kUsualWidth = 7, kFurthest = 1e5, kWidest = 1000;
constexpr std::size_t kDeepest = 32;
constexpr const char* kRemedy =
    R"(Expected: {"format": "freshet-marks", "version": 1, "marks": [{"is": "fluid", "points": [[x, y]]}, )"
    R"({"is": "within", "box": [x, y, width, height]}]})";

Json parse(const std::filesystem::path& path) {
  std::error_code fault;
  if (!std::filesystem::exists(path, fault))
    throw Error(ErrorKind::kInput, path.string(), "there is no such file", "Check the name");
  const std::uintmax_t size =
      std::filesystem::is_regular_file(path, fault) ? std::filesystem::file_size(path, fault) : 0;
  if (fault || size == 0 || size > kMaxBytes)
    throw Error(ErrorKind::kInput, path.string(), fmt::format("it is no file of 1 to {} bytes", kMaxBytes),
                kRemedy);
  const std::string text = read_text_file(path, kMaxBytes, kRemedy);
  expect_nesting(json_nesting(text), kDeepest, path.string(), kRemedy);
  try {
    return Json::parse(text);
  } catch (const Json::exception& reason) {
    throw Error(ErrorKind::kInput, path.string(), fmt::format("not a JSON file ({})", reason.what()),
                kRemedy);
  }
}

}  // namespace

Marks read_marks(const std::filesystem::path& path, cv::Size picture) {
  const Json json = parse(path);
  const auto fail = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, path.string(), fault, kRemedy);
  };
  const auto numbers = [&](const Json& list, std::size_t count, const std::string& fault) {
    std::vector<double> out;
    if (!list.is_array() || list.size() != count) fail(fault);
    for (const Json& entry : list) {
      out.push_back(entry.is_number() ? entry.get<double>() : NAN);
      if (!(std::abs(out.back()) <= kFurthest)) fail(fault);
    }
    return out;
  };
  if (!json.is_object() || json.value("format", Json()) != "freshet-marks")
    fail("\"format\" is not \"freshet-marks\"");
  if (json.value("version", Json()) != 1) fail("\"version\" is not 1");
  if (!json.contains("marks") || !json["marks"].is_array()) fail("\"marks\" is not a list");
  if (json["marks"].empty()) fail("no mark in it");
  if (json["marks"].size() > kMaxMarks) fail(fmt::format("more than {} marks", kMaxMarks));

  Marks marks(picture, CV_8U, cv::Scalar(kUnknown));
  std::vector<cv::Rect2d> within;
  std::size_t number = 0, points_read = 0;
  for (const Json& entry : json["marks"]) {
    const std::string name = fmt::format("mark {}", ++number);
    if (!entry.is_object()) fail(name + " is not an object");
    const Json is = entry.value("is", Json());
    if (is != "fluid" && is != "background" && is != "within")
      fail(name + ": \"is\" is none of fluid, background, within");
    const std::uint8_t mark = is == "fluid" ? kFluid : kBackground;
    if (entry.contains("box")) {
      const std::vector<double> box =
          numbers(entry["box"], 4, name + ": a box is four numbers of px: x, y, width, height");
      const cv::Rect2d area(box[0], box[1], box[2], box[3]);
      Marks painted(picture, CV_8U, cv::Scalar(kUnknown));
      try {
        keep_within(painted, {area}, path.string());
      } catch (const Error&) {
        fail(fmt::format("{}: its box has no area in the picture of {} x {} px", name, picture.width,
                         picture.height));
      }
      if (is == "within")
        within.push_back(area);
      else
        marks.setTo(mark, painted == kUnknown);
      continue;
    }
    if (is == "within" || !entry.contains("points")) fail(name + ": \"box\" or \"points\" expected");
    if (!entry["points"].is_array() || entry["points"].empty()) fail(name + ": \"points\" is not a list");
    if ((points_read += entry["points"].size()) > kMaxPoints) fail("more than a million points");
    const Json width_entry = entry.value("width", Json(kUsualWidth));
    const double width = width_entry.is_number() ? width_entry.get<double>() : NAN;
    if (!(width > 0 && width <= kWidest)) fail(name + ": \"width\" is not 0 to 1000 px");
    // Sixteenths of a pixel; the middle of the first pixel is at 0.5.
    std::vector<cv::Point> line;
    for (const Json& point : entry["points"]) {
      const std::vector<double> at = numbers(point, 2, name + ": a point is two numbers of px");
      line.emplace_back(cvRound((at[0] - 0.5) * 16), cvRound((at[1] - 0.5) * 16));
    }
    if (line.size() == 1) line.push_back(line[0]);
    cv::Mat drawn(picture, CV_8U, cv::Scalar(0));
    const int thickness = std::max(1, cvRound(width));
    for (std::size_t i = 1; i < line.size(); ++i)
      cv::line(drawn, line[i - 1], line[i], cv::Scalar(255), thickness, cv::LINE_8, 4);
    if (cv::countNonZero(drawn) == 0)
      fail(fmt::format("{} lies outside the picture of {} x {} px", name, picture.width, picture.height));
    marks.setTo(mark, drawn);
  }
  if (!within.empty()) keep_within(marks, within, path.string());
  return marks;
}

}  // namespace freshet::synth::matte
