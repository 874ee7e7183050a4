#include "synth/flowlines/files/line_drawing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "hints/motion_maps.h"

namespace freshet::synth::flowlines {
namespace {

const cv::Scalar kWhite(255, 255, 255);

int thickness(const cv::Mat& picture) { return std::max(1, picture.cols / 400); }

void draw_line(cv::Mat& out, const FlowLine& line, int thick) {
  for (int s = 0; s + 3 < line.samples(); s += 3) {
    const cv::Point2f along = tangent(line, s);
    const cv::Vec3f colour = hints::colour_of_direction(cv::Vec2f(along.x, along.y)) * 255;
    cv::line(out, cv::Point(line.points[static_cast<std::size_t>(s)]),
             cv::Point(line.points[static_cast<std::size_t>(s) + 3]),
             cv::Scalar(colour[0], colour[1], colour[2]), thick, cv::LINE_AA);
  }
  const cv::Point2f end = line.points.back(), back = tangent(line, line.samples() - 1);
  cv::arrowedLine(out, cv::Point(end - back * 8.0f), cv::Point(end), kWhite, thick, cv::LINE_AA, 0, 0.6);
  cv::circle(out, cv::Point(line.points.front()), 2 * thick, kWhite, cv::FILLED, cv::LINE_AA);
}

void draw_name(cv::Mat& out, const FlowLine& line, const std::string& name) {
  cv::putText(out, name, cv::Point(line.points[line.points.size() / 3]), cv::FONT_HERSHEY_SIMPLEX,
              0.35 * std::max(1.0, out.cols / 640.0), kWhite, 1, cv::LINE_AA);
}

void draw_ticks(cv::Mat& out, const FlowLine& line) {
  const float apart = static_cast<float>(out.rows) / 12, half = 3.0f * static_cast<float>(thickness(out));
  float ridden = 0;
  for (int s = 1; s < line.samples(); ++s) {
    const float before = ridden;
    ridden += 1 / speed_at(line, static_cast<float>(s));
    if (std::floor(ridden / apart) == std::floor(before / apart)) continue;
    const cv::Point2f here = line.points[static_cast<std::size_t>(s)], way = tangent(line, s);
    const cv::Point2f across(-way.y * half, way.x * half);
    cv::line(out, cv::Point(here - across), cv::Point(here + across), kWhite, thickness(out), cv::LINE_AA);
  }
}

cv::Mat drawn_edited(const cv::Mat& picture, const std::vector<FlowLine>& edited) {
  cv::Mat out = picture / 2;
  const std::size_t names_every = std::max<std::size_t>(1, edited.size() / 24);
  for (std::size_t i = 0; i < edited.size(); ++i) {
    const FlowLine& line = edited[i];
    const bool later = line.time_s.value_or(0) > 0;
    draw_line(out, line, later ? 1 : thickness(out));
    draw_ticks(out, line);
    if (line.time_s)
      draw_name(out, line, fmt::format("{} {:.4g} s", line.name, *line.time_s));
    else if (i % names_every == 0)
      draw_name(out, line, line.name);
  }
  return out;
}

}  // namespace

cv::Mat draw_lines(const cv::Mat& picture, const cv::Mat& matte, const std::vector<FlowLine>& lines,
                   const std::vector<FlowLine>& edited) {
  cv::Mat out = picture.clone(), dim = picture / 3;
  dim.copyTo(out, matte < 128);
  const std::size_t names_every = std::max<std::size_t>(1, lines.size() / 24);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    draw_line(out, lines[i], thickness(out));
    if (i % names_every == 0) draw_name(out, lines[i], lines[i].name);
  }
  if (!edited.empty()) cv::hconcat(out, drawn_edited(picture, edited), out);
  return out;
}

}  // namespace freshet::synth::flowlines
