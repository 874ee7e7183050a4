#include "synth/flowlines/lines/flow_line.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace freshet::synth::flowlines {

FlowLine evenly(const std::vector<cv::Point2f>& chain, std::string name, float step) {
  FlowLine line{.points = {}, .name = std::move(name)};
  if (chain.size() < 2) return line;
  line.points.push_back(chain.front());
  float left = step;  // until the next sample
  for (std::size_t i = 1; i < chain.size(); ++i) {
    const cv::Point2f way = chain[i] - chain[i - 1];
    const auto length = static_cast<float>(cv::norm(way));
    float done = 0;
    while (length - done >= left) {
      done += left;
      line.points.push_back(chain[i - 1] + way * (done / length));
      left = step;
    }
    left -= length - done;
  }
  if (line.points.size() < 2) line.points.clear();
  return line;
}

cv::Point2f tangent(const FlowLine& line, int sample, int reach) {
  const int last = line.samples() - 1;
  const int here = std::clamp(sample, 0, last);  // beyond its ends the line goes on straight
  const int from = std::max(here - reach, 0), to = std::min(here + reach, last);
  const cv::Point2f way =
      line.points[static_cast<std::size_t>(to)] - line.points[static_cast<std::size_t>(from)];
  const auto length = static_cast<float>(cv::norm(way));
  return length > 0 ? way * (1 / length) : cv::Point2f(1, 0);
}

cv::Point2f at(const FlowLine& line, float arc) {
  const int last = line.samples() - 1;
  const int i = std::clamp(static_cast<int>(std::floor(arc)), 0, last - 1);
  const cv::Point2f from = line.points[static_cast<std::size_t>(i)];
  const cv::Point2f way = line.points[static_cast<std::size_t>(i) + 1] - from;
  if (arc < 0 || arc > static_cast<float>(last)) {
    const int end = arc < 0 ? 0 : last;
    return line.points[static_cast<std::size_t>(end)] + tangent(line, end) * (arc - static_cast<float>(end));
  }
  return from + way * (arc - static_cast<float>(i));
}

float speed_at(const FlowLine& line, float arc) {
  if (line.speeds.size() < 2) return line.speeds.empty() ? 1.0f : line.speeds.front();
  const auto most = static_cast<float>(line.speeds.size() - 1);
  const float along = std::clamp(arc / line.length(), 0.0f, 1.0f) * most;
  const auto i = static_cast<std::size_t>(std::min(along, most - 1));
  const float part = along - static_cast<float>(i);
  return line.speeds[i] * (1 - part) + line.speeds[i + 1] * part;
}

FlowLine scaled(const FlowLine& line, float by) {
  std::vector<cv::Point2f> chain;
  chain.reserve(line.points.size());
  // Pixels' middles lie at whole numbers: the corner of the picture stays where it is.
  for (const cv::Point2f& point : line.points)
    chain.emplace_back((point.x + 0.5f) * by - 0.5f, (point.y + 0.5f) * by - 0.5f);
  FlowLine out = evenly(chain, line.name);
  out.speeds = line.speeds;
  out.time_s = line.time_s;
  return out;
}

}  // namespace freshet::synth::flowlines
