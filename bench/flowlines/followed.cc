#include "bench/flowlines/followed.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/quality/quality_footage.h"
#include "synth/flowlines/clip_motion.h"
#include "synth/flowlines/edit.h"
#include "synth/flowlines/rides.h"

namespace freshet::bench {
namespace {

namespace flowlines = synth::flowlines;
using flowlines::FlowLine;

constexpr int kEnds = 12, kStep = 4;  // samples of a line that are left out at its ends; between places
constexpr double kLeastSpeed = 0.1;   // px a frame: slower has no direction worth measuring

/// How a film moves along some lines.
struct Measured {
  cv::Mat flow;  // CV_32FC2, px a frame
  flowlines::Rides rides;
};

Measured measured(const std::vector<cv::Mat>& frames, const std::vector<FlowLine>& lines) {
  const std::vector<cv::Mat> luma = luma_of(frames);
  const flowlines::ClipMotion motion = flowlines::measure_motion(luma);
  return {motion.mean,
          flowlines::follow(
              luma, lines, motion,
              {.dynamics = flowlines::Dynamics::kStationary, .patch_px = kRibbonPx, .min_speed = 0.02})};
}

double degrees_between(cv::Point2f a, cv::Point2f b) {
  const double cosine = a.dot(b) / std::max(1e-6, cv::norm(a) * cv::norm(b));
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180 / std::numbers::pi;
}

cv::Point2f flow_at(const cv::Mat& flow, cv::Point2f at) {
  const cv::Vec2f v = flow.at<cv::Vec2f>(cv::Point(cvRound(at.x), cvRound(at.y)));
  return {v[0], v[1]};
}

}  // namespace

Followed followed(const std::vector<cv::Mat>& film, const std::vector<cv::Mat>& clip,
                  const std::vector<FlowLine>& inputs, const std::vector<FlowLine>& edited,
                  flowlines::Correspondence correspondence, const cv::Mat& shown) {
  const Measured made = measured(film, edited), was = measured(clip, inputs);
  const std::vector<int> partner = flowlines::partners(inputs, edited, "edited lines");
  const cv::Rect inside(8, 8, made.flow.cols - 16, made.flow.rows - 16);
  Followed out;
  double weights = 0;
  for (std::size_t i = 0; i < edited.size(); ++i) {
    const auto of = static_cast<std::size_t>(partner[i]);
    const FlowLine &line = edited[i], &input = inputs[of];
    const flowlines::ArcMap arc_of(line, input, correspondence);
    for (int s = kEnds; s + kEnds < line.samples(); s += kStep) {
      const auto sample = static_cast<std::size_t>(s);
      const float arc = arc_of(static_cast<float>(s));
      const int from = cvRound(arc);
      if (from < kEnds || from + kEnds >= input.samples()) continue;
      const cv::Point2f here = line.points[sample], there = flowlines::at(input, arc);
      if (!inside.contains(here) || !inside.contains(there)) continue;
      if (!shown.empty() && shown.at<std::uint8_t>(cv::Point(here)) == 0) continue;
      const cv::Point2f v = flow_at(made.flow, here), u = flow_at(was.flow, there);
      const double weight = u.dot(flowlines::tangent(input, from));
      if (weight < kLeastSpeed) continue;
      // What the edited line makes of a step of the input line: its speed, and what stretching adds.
      const double drawn = 1 / std::max(1e-3f, arc_of(static_cast<float>(s) + 1) - arc);
      const auto log2_ratio = [&](double is, double old) {
        return std::log2(std::max(0.05, is) / (std::max(0.05, old) * drawn));
      };
      const double by_ribbon =
          log2_ratio(static_cast<double>(made.rides.lines[i].speed[sample]),
                     static_cast<double>(was.rides.lines[of].speed[static_cast<std::size_t>(from)]));
      out.degrees += weight * degrees_between(v, flowlines::tangent(line, s));
      out.clip_degrees += weight * degrees_between(u, flowlines::tangent(input, from));
      out.flow_speed += weight * std::abs(log2_ratio(cv::norm(v), cv::norm(u)));
      out.ribbon_speed += weight * std::abs(by_ribbon);
      out.slower += weight * by_ribbon;
      weights += weight;
      ++out.places;
    }
  }
  for (double* mean : {&out.degrees, &out.clip_degrees, &out.flow_speed, &out.ribbon_speed, &out.slower})
    *mean /= std::max(1e-9, weights);
  return out;
}

std::vector<FlowLine> bent(const std::vector<FlowLine>& lines, double degrees) {
  cv::Point2f middle(0, 0), way(0, 0);
  std::size_t samples = 0;
  for (const FlowLine& line : lines) {
    way += line.points.back() - line.points.front();
    for (const cv::Point2f& point : line.points) middle += point;
    samples += line.points.size();
  }
  middle *= 1.0f / static_cast<float>(samples);
  way *= 1 / std::max(1e-6f, static_cast<float>(cv::norm(way)));
  const cv::Point2f across(-way.y, way.x);
  float furthest = 1, widest = 1;
  for (const FlowLine& line : lines)
    for (const cv::Point2f& point : line.points) {
      furthest = std::max(furthest, std::abs((point - middle).dot(way)));
      widest = std::max(widest, std::abs((point - middle).dot(across)));
    }
  // Ways from the middle become an arc's; what lies beside them stays as far beside it.
  const float radius =
      std::max(furthest / static_cast<float>(degrees * std::numbers::pi / 180), 1.5f * widest);
  std::vector<FlowLine> out;
  for (const FlowLine& line : lines) {
    std::vector<cv::Point2f> chain;
    for (const cv::Point2f& point : line.points) {
      const float angle = (point - middle).dot(way) / radius, beside = (point - middle).dot(across) - radius;
      chain.push_back(middle + way * (-beside * std::sin(angle)) +
                      across * (radius + beside * std::cos(angle)));
    }
    out.push_back(flowlines::evenly(chain, line.name));
  }
  return out;
}

}  // namespace freshet::bench
