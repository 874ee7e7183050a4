#include "synth/scene/measured/clip_sway.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/scene/motion/tree_sway.h"
#include "vision/flow.h"

namespace freshet::synth::scene {
namespace {

constexpr int kPoints = 64;       // along an armature
constexpr double kFirst = 0.25;   // of its length: below, nearly nothing moves
constexpr double kLargest = 320;  // px, of what is followed
constexpr double kBeside = 0.4;   // of an armature's length, about it

/// A point of an armature that the film shows.
struct Seen {
  cv::Point at;  // px of what is followed
  float bent;    // of the tip's displacement
};
struct Followed {
  cv::Point2f side;  // unit, to the right of the way
  float length;      // px
  std::vector<Seen> points;
};

/// What lies about the armatures.
cv::Rect region_of(const std::vector<Line>& armatures, cv::Size frame) {
  cv::Rect2d all;
  for (const Line& line : armatures) {
    const double beside = kBeside * cv::norm(line.to - line.from);
    const cv::Point2d by(beside, beside);
    const cv::Rect2d one(
        cv::Point2d(std::min(line.from.x, line.to.x), std::min(line.from.y, line.to.y)) - by,
        cv::Point2d(std::max(line.from.x, line.to.x), std::max(line.from.y, line.to.y)) + by);
    all = all.empty() ? one : all | one;
  }
  const cv::Rect2d shown = all & cv::Rect2d(0, 0, frame.width, frame.height);
  return cv::Rect(cv::Point(cvFloor(shown.x), cvFloor(shown.y)),
                  cv::Point(cvCeil(shown.br().x), cvCeil(shown.br().y)));
}

Followed followed(const Line& line, const cv::Rect& region, double scale, cv::Size size) {
  const cv::Point2d way = line.to - line.from;
  const double length = cv::norm(way);
  Followed out{cv::Point2f(cv::Point2d(-way.y, way.x) / length), static_cast<float>(length * scale), {}};
  for (int i = 0; i < kPoints; ++i) {
    const double u = kFirst + (1 - kFirst) * i / (kPoints - 1);
    const cv::Point2d p = (line.from + way * u - cv::Point2d(region.tl())) * scale;
    const cv::Point at(cvFloor(p.x), cvFloor(p.y));
    if (cv::Rect({0, 0}, size).contains(at)) out.points.push_back({at, static_cast<float>(bend(u))});
  }
  return out;
}

/// How unlike the first frame's armatures are to where the flow says that they are, a mean of levels.
double unlikeness(const cv::Mat& first, const cv::Mat& now, const cv::Mat& flow,
                  const std::vector<Followed>& plants) {
  constexpr int kBy = 2;  // px about each point
  double sum = 0;
  int count = 0;
  for (const Followed& plant : plants)
    for (const Seen& seen : plant.points) {
      const auto& by = flow.at<cv::Vec2f>(seen.at);
      for (int y = -kBy; y <= kBy; ++y)
        for (int x = -kBy; x <= kBy; ++x) {
          const cv::Point a = seen.at + cv::Point(x, y), b = a + cv::Point(cvRound(by[0]), cvRound(by[1]));
          if (!cv::Rect({0, 0}, first.size()).contains(a)) continue;
          ++count;
          sum += cv::Rect({0, 0}, first.size()).contains(b)
                     ? std::abs(int(first.at<uchar>(a)) - int(now.at<uchar>(b)))
                     : 128;
        }
    }
  return sum / std::max(1, count);
}

float tip_of(const Followed& plant, const cv::Mat& flow, std::vector<std::pair<float, float>>& tips) {
  tips.clear();
  float half = 0;
  for (const Seen& seen : plant.points) {
    const auto& by = flow.at<cv::Vec2f>(seen.at);
    tips.emplace_back((by[0] * plant.side.x + by[1] * plant.side.y) / (plant.length * seen.bent), seen.bent);
    half += seen.bent / 2;
  }
  std::sort(tips.begin(), tips.end());
  std::size_t i = 0;
  for (float sum = 0; i + 1 < tips.size(); ++i)
    if ((sum += tips[i].second) >= half) break;
  return tips[i].first;
}

}  // namespace

std::vector<std::vector<float>> clip_sway(const std::function<std::optional<cv::Mat>()>& next,
                                          const std::vector<Line>& armatures, const std::string& film) {
  std::vector<std::vector<float>> tips(armatures.size());
  std::vector<Followed> plants;
  std::vector<std::pair<float, float>> room;
  cv::Size frame_size;
  cv::Rect region;
  double scale = 1;
  cv::Mat first, now, flow;
  while (const std::optional<cv::Mat> frame = next()) {
    if (first.empty()) {
      frame_size = frame->size();
      region = region_of(armatures, frame_size);
      scale = std::min(1.0, kLargest / std::max(region.width, region.height));
    }
    if (frame->size() != frame_size)
      throw Error(ErrorKind::kInput, film, "its frames change their size", "Give a film of one size");
    if (!region.empty()) cv::resize((*frame)(region), now, {}, scale, scale, cv::INTER_AREA);
    if (first.empty()) {
      for (const Line& line : armatures) {
        plants.push_back(followed(line, region, scale, now.size()));
        if (plants.back().points.size() < kPoints / 8)
          throw Error(
              ErrorKind::kInput, film,
              fmt::format("its {} x {} px do not show the plant from ({:.0f}, {:.0f}) to ({:.0f}, {:.0f})",
                          frame_size.width, frame_size.height, line.from.x, line.from.y, line.to.x,
                          line.to.y),
              "Draw motion_armature over its first frame");
      }
      now.copyTo(first);
      flow = cv::Mat(first.size(), CV_32FC2, cv::Scalar::all(0));
    } else {
      cv::Mat on = vision::refined_flow(first, now, flow), anew = vision::optical_flow(first, now);
      flow = unlikeness(first, now, on, plants) <= unlikeness(first, now, anew, plants) ? on : anew;
    }
    for (std::size_t i = 0; i < plants.size(); ++i) tips[i].push_back(tip_of(plants[i], flow, room));
  }
  return tips;
}

}  // namespace freshet::synth::scene
