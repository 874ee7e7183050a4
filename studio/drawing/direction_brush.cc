#include "studio/drawing/direction_brush.h"

#include <algorithm>
#include <cmath>

#include "studio/drawing/drawn_matte.h"

namespace freshet::studio {
namespace {

constexpr int kLongest = 1024;  // px of the map of what is covered
constexpr float kFinest = 2;    // px between a line's points
constexpr float kSteps = 16;    // of a band's width
constexpr int kNear = 16;       // points of the middle line that one beside it is compared with, to each side
constexpr float kLeast = 0.97f;                                // of how far it lies aside
constexpr float kShortest = 4;                                 // px of a line
constexpr float kBeside[] = {0.0f, -0.2f, 0.2f, -0.4f, 0.4f};  // of the width

/// The line walked at even steps; its last point is kept.
std::vector<cv::Point2f> evenly(const std::vector<cv::Point2f>& points, float step) {
  std::vector<cv::Point2f> walked{points.front()};
  float left = step;
  for (std::size_t i = 1; i < points.size(); ++i) {
    cv::Point2f from = points[i - 1];
    auto length = static_cast<float>(cv::norm(points[i] - from));
    for (; length >= left; left = step) {
      from += (points[i] - from) * (left / length);
      length -= left;
      walked.push_back(from);
    }
    left -= length;
  }
  if (cv::norm(walked.back() - points.back()) > 0.25f * step) walked.push_back(points.back());
  return walked;
}

/// Its middle line moved aside. Where it turns more sharply than it is wide, points that come too near to it are left
/// out.
std::vector<cv::Point2f> beside(const std::vector<cv::Point2f>& middle, float by) {
  std::vector<cv::Point2f> line;
  const auto count = static_cast<int>(middle.size());
  for (int i = 0; i < count; ++i) {
    const auto at = [&](int k) { return middle[static_cast<std::size_t>(std::clamp(k, 0, count - 1))]; };
    const cv::Point2f way = at(i + 1) - at(i - 1);
    const auto length = static_cast<float>(cv::norm(way));
    if (length == 0) continue;
    const cv::Point2f point = at(i) + cv::Point2f(-way.y, way.x) * (by / length);
    bool fits = true;
    for (int k = i - kNear; fits && k <= i + kNear; ++k)
      fits = cv::norm(point - at(k)) >= kLeast * std::abs(by);
    if (fits) line.push_back(point);
  }
  return line;
}

/// The parts of a line that lie in the picture and are not covered.
void add_parts(const std::vector<cv::Point2f>& line, const cv::Mat& covered, float scale,
               std::vector<DrawnStroke>& strokes) {
  std::vector<cv::Point2f> part;
  const auto end_part = [&] {
    if (part.size() > 1 && cv::norm(part.back() - part.front()) >= kShortest)
      strokes.push_back({.points = part, .speed = {}});
    part.clear();
  };
  for (const cv::Point2f& point : line) {
    const cv::Point at(cvFloor(point.x * scale), cvFloor(point.y * scale));
    if (cv::Rect({}, covered.size()).contains(at) && covered.at<std::uint8_t>(at) == 0)
      part.push_back(point);
    else
      end_part();
  }
  end_part();
}

}  // namespace

std::vector<DrawnStroke> brush_strokes(const std::vector<Drawn>& brush, cv::Size picture) {
  std::vector<DrawnStroke> strokes;
  if (brush.empty()) return strokes;
  const float scale = std::min(1.0f, kLongest / static_cast<float>(std::max(picture.width, picture.height)));
  cv::Mat covered = cv::Mat::zeros(std::max(1, cvRound(static_cast<float>(picture.height) * scale)),
                                   std::max(1, cvRound(static_cast<float>(picture.width) * scale)), CV_8U);
  // From the last one back: what it covers is not for those before it.
  for (std::size_t i = brush.size(); i-- > 0;) {
    const std::vector<cv::Point2f> middle =
        evenly(brush[i].points, std::max(kFinest, brush[i].width / kSteps));
    if (brush[i].adds)
      for (const float by : kBeside) add_parts(beside(middle, by * brush[i].width), covered, scale, strokes);
    Drawn band = brush[i];
    band.adds = true;
    band.width *= scale;
    for (cv::Point2f& point : band.points) point *= scale;
    paint({band}, covered);
  }
  return strokes;
}

}  // namespace freshet::studio
