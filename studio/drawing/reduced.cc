#include "studio/drawing/reduced.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace freshet::studio {
namespace {

void scale_points(std::vector<cv::Point2f>& points, float scale) {
  for (cv::Point2f& point : points) point *= scale;
}

void scale_line(Drawn& line, float scale) {
  scale_points(line.points, scale);
  line.width *= scale;
}

void scale_stroke(DrawnStroke& stroke, float scale) {
  scale_points(stroke.points, scale);
  if (stroke.speed) *stroke.speed *= scale;
}

}  // namespace

double reduction(cv::Size size, int side) {
  return std::max(1.0, std::max(size.width, size.height) / static_cast<double>(side));
}

cv::Mat reduced(const cv::Mat& picture, double factor) {
  if (factor <= 1 || picture.empty()) return picture;
  cv::Mat small;
  cv::resize(picture, small,
             {std::max(1, cvRound(picture.cols / factor)), std::max(1, cvRound(picture.rows / factor))}, 0, 0,
             cv::INTER_AREA);
  return small;
}

Document reduced(const Document& document, double factor) {
  Document small = document;
  small.pins.clear();
  const auto scale = static_cast<float>(1 / factor);
  for (DrawnStroke& stroke : small.strokes) scale_stroke(stroke, scale);
  for (Drawn& line : small.directions) scale_line(line, scale);
  return small;
}

DrawnScene reduced(const DrawnScene& scene, double factor) {
  DrawnScene small = scene;
  const auto scale = static_cast<float>(1 / factor);
  for (DrawnLayer& layer : small.layers) {
    for (Drawn& line : layer.paint) scale_line(line, scale);
    for (DrawnStroke& line : layer.lines) scale_stroke(line, scale);
    layer.shimmer *= scale;
    layer.drift *= scale;
    layer.glow_reach *= scale;
  }
  return small;
}

}  // namespace freshet::studio
