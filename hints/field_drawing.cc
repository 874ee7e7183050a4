#include "hints/field_drawing.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "hints/motion_maps.h"

namespace freshet::hints {
namespace {

constexpr int kShift = 4;  // of OpenCV's fixed point: sixteenths of a pixel
const cv::Scalar kOutline(16, 16, 16), kStroke(255, 255, 255);

cv::Point fixed(cv::Point2f point) {
  const auto coordinate = [](float value) { return cvRound(std::clamp(value, -1e6f, 1e6f) * (1 << kShift)); };
  return {coordinate(point.x), coordinate(point.y)};
}

void line(cv::Mat& drawing, cv::Point2f from, cv::Point2f to, const cv::Scalar& colour, int thickness) {
  cv::line(drawing, fixed(from), fixed(to), colour, thickness, cv::LINE_AA, kShift);
}

// A solid head whose tip lies at `tip`.
void head(cv::Mat& drawing, cv::Point2f tip, cv::Point2f way, float length, const cv::Scalar& colour) {
  const cv::Point2f base = tip - way * length, side = cv::Point2f(-way.y, way.x) * (length * 0.45f);
  const cv::Point corners[3] = {fixed(tip), fixed(base + side), fixed(base - side)};
  cv::fillConvexPoly(drawing, corners, 3, colour, cv::LINE_AA, kShift);
}

struct Arrow {
  cv::Point2f middle{}, way{};
  float length = 0;  // px; 0: a disc
  float radius = 0;  // px, of the disc
  cv::Scalar colour{};
};

void draw(cv::Mat& drawing, const Arrow& arrow, int thickness) {
  if (arrow.length <= 0) {
    cv::circle(drawing, fixed(arrow.middle), cvRound((arrow.radius + 1.5f) * (1 << kShift)), kOutline,
               cv::FILLED, cv::LINE_AA, kShift);
    cv::circle(drawing, fixed(arrow.middle), cvRound(arrow.radius * (1 << kShift)), arrow.colour, cv::FILLED,
               cv::LINE_AA, kShift);
    return;
  }
  const float wedge = std::min(arrow.length * 0.6f, 4.0f + 3.0f * static_cast<float>(thickness));
  const cv::Point2f tip = arrow.middle + arrow.way * (arrow.length / 2),
                    tail = tip - arrow.way * arrow.length, neck = tip - arrow.way * (wedge * 0.8f);
  line(drawing, tail, neck, kOutline, thickness + 2);
  head(drawing, tip + arrow.way * 2.5f, arrow.way, wedge + 4.5f, kOutline);
  line(drawing, tail, neck, arrow.colour, thickness);
  head(drawing, tip, arrow.way, wedge, arrow.colour);
}

// The speed that the longest arrow stands for.
float long_speed(const cv::Mat& speed, const cv::Mat& matte) {
  std::vector<float> asked;
  for (int y = 0; y < speed.rows; y += 4)
    for (int x = 0; x < speed.cols; x += 4)
      if (matte.at<std::uint8_t>(y, x) > 0 && speed.at<float>(y, x) >= 0)
        asked.push_back(speed.at<float>(y, x));
  if (asked.empty()) return 1;
  const auto high = asked.begin() + static_cast<std::ptrdiff_t>(asked.size() * 95 / 100);
  std::nth_element(asked.begin(), high, asked.end());
  return std::max(*high, 1e-3f);
}

void draw_stroke(cv::Mat& drawing, const Stroke& stroke, int thickness) {
  for (const bool outline : {true, false}) {
    const cv::Scalar& colour = outline ? kOutline : kStroke;
    for (std::size_t i = 1; i < stroke.points.size(); ++i)
      line(drawing, stroke.points[i - 1], stroke.points[i], colour, outline ? thickness + 4 : thickness);
    // The head points as the last stretch of the stroke does.
    const cv::Point2f end = stroke.points.back();
    cv::Point2f way(0, 0);
    for (std::size_t i = stroke.points.size() - 1; i-- > 0;) {
      way = end - stroke.points[i];
      if (cv::norm(way) > 6) break;
    }
    const auto length = static_cast<float>(cv::norm(way));
    if (length <= 0) continue;
    way /= length;
    const auto size = static_cast<float>(6 + 4 * thickness);
    head(drawing, end + way * (outline ? size * 0.5f + 3 : size * 0.5f), way, outline ? size + 6 : size,
         colour);
  }
}

}  // namespace

cv::Mat draw_field(const cv::Mat& picture, const cv::Mat& matte, const cv::Mat& direction,
                   const cv::Mat& speed, const std::vector<Stroke>& strokes) {
  cv::Mat drawing = picture.clone();
  for (int y = 0; y < drawing.rows; ++y)
    for (int x = 0; x < drawing.cols; ++x) {
      const int fraction = 110 + 145 * matte.at<std::uint8_t>(y, x) / 255;
      cv::Vec3b& pixel = drawing.at<cv::Vec3b>(y, x);
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(pixel[c] * fraction / 255);
    }
  const int longer = std::max(picture.cols, picture.rows), spacing = std::max(24, longer / 26);
  const int thickness = std::max(1, spacing / 14);
  const float full = speed.empty() ? 0 : long_speed(speed, matte),
              longest = 0.95f * static_cast<float>(spacing);
  for (int y = spacing / 2; y < picture.rows; y += spacing)
    for (int x = spacing / 2; x < picture.cols; x += spacing) {
      if (matte.at<std::uint8_t>(y, x) <= 127) continue;
      const cv::Vec2f way = direction.empty() ? cv::Vec2f(0, 0) : direction.at<cv::Vec2f>(y, x);
      const float here = speed.empty() ? -1 : speed.at<float>(y, x);
      const float fraction = here < 0 ? 0.8f : std::min(1.0f, here / full);
      Arrow arrow{cv::Point2f(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f), {way[0], way[1]}};
      if (way != cv::Vec2f(0, 0)) {
        arrow.length = std::max(0.2f, fraction) * longest;
        arrow.colour =
            cv::Scalar(colour_of_direction(way) * 165 + cv::Vec3f(90, 90, 90));  // blue alone is too dark
      } else if (here >= 0) {
        arrow.radius = std::max(0.1f, fraction) * longest / 3;
        arrow.colour = cv::Scalar::all(230);
      } else {
        continue;
      }
      draw(drawing, arrow, thickness);
    }
  for (const Stroke& stroke : strokes) draw_stroke(drawing, stroke, std::max(2, thickness + 1));
  return drawing;
}

}  // namespace freshet::hints
