#include "synth/stills/still_pins.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::stills {
namespace {

constexpr double kSamePart = 1. / 480;  // of the longer side: nearer points are one
constexpr double kNearPart = 1. / 120;  // of it: nearer points are of one thing

cv::Point2d led(const cv::Matx33d& map, cv::Point2d at) {
  const cv::Vec3d place = map * cv::Vec3d(at.x, at.y, 1);
  return {place[0] / place[2], place[1] / place[2]};
}

// Of pixels, whose middles have whole numbers.
bool holds(cv::Size size, cv::Point2d at) {
  return at.x >= -.5 && at.y >= -.5 && at.x <= size.width - .5 && at.y <= size.height - .5;
}

cv::Point2d placed(const std::string& name, const char* key, cv::Point2d at, int still, const StillSet& set) {
  const std::string where = name + ": " + key;
  if (!holds(set.file_size, at))
    throw Error(ErrorKind::kInput, where,
                fmt::format("[{:g}, {:g}] lies outside {}, which is {} x {} px", at.x, at.y, set.names[still],
                            set.file_size.width, set.file_size.height),
                "Give px of the file as it is shown upright, from its upper left pixel");
  const cv::Point2d place = led(set.from_file[still], at);
  if (!holds(set.size(), place))
    throw Error(ErrorKind::kInput, where,
                fmt::format("[{:g}, {:g}] of {} was cut off when the stills were aligned", at.x, at.y,
                            set.names[still]),
                "Pin a point that all stills show, or say --camera tripod if the camera stood still");
  return place;
}

void refuse_contradictions(const std::vector<PlacedPin>& pins, double longer_side) {
  for (std::size_t j = 0; j < pins.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const PlacedPin &one = pins[i], &other = pins[j];
      if (one.from != other.from || one.to != other.to) continue;
      const double apart = cv::norm(one.at - other.at), apart_after = cv::norm(one.goes - other.goes);
      const double same = kSamePart * longer_side;
      if (apart < same && apart_after < same)
        throw Error(ErrorKind::kInput, other.name, fmt::format("it is on the same point as {}", one.name),
                    "Take one of the two out");
      const double least = std::min(apart, apart_after);
      if (least < kNearPart * longer_side && cv::norm((one.goes - one.at) - (other.goes - other.at)) > least)
        throw Error(
            ErrorKind::kInput, other.name,
            fmt::format("it contradicts {}: their points are {:.1f} px apart in one still and {:.1f} px in "
                        "the other",
                        one.name, apart, apart_after),
            "Points so near belong to one thing: take one pin out, or correct it");
    }
}

}  // namespace

std::vector<PlacedPin> placed_pins(const std::vector<StillPin>& pins, const StillSet& set) {
  const double longer_side = std::max(set.size().width, set.size().height);
  std::vector<PlacedPin> out;
  for (const StillPin& pin : pins) {
    const std::string name = fmt::format("pin {} ({} to {})", out.size() + 1, pin.from, pin.to);
    PlacedPin placing{.name = name,
                      .from = still_named(pin.from, set.names, name),
                      .to = still_named(pin.to, set.names, name),
                      .at = {},
                      .goes = {},
                      .reach = kPinReach * longer_side};
    if (placing.from == placing.to)
      throw Error(ErrorKind::kInput, name, "it leads from a still to itself", "Name two stills");
    placing.at = placed(name, "at", pin.at, placing.from, set);
    placing.goes = placed(name, "goes", pin.goes, placing.to, set);
    if (pin.reach) {
      const cv::Point2d beside = led(set.from_file[placing.from], pin.at + cv::Point2d(1, 0));
      placing.reach = *pin.reach * cv::norm(beside - placing.at);
    }
    if (placing.from > placing.to) {
      std::swap(placing.from, placing.to);
      std::swap(placing.at, placing.goes);
    }
    out.push_back(std::move(placing));
  }
  refuse_contradictions(out, longer_side);
  return out;
}

std::vector<FlowPin> flow_pins(const std::vector<PlacedPin>& pins, int from, int to, const cv::Rect& box,
                               cv::Size flow) {
  constexpr double kLeastReach = 4;  // px of the flow
  const double across = static_cast<double>(flow.width) / box.width,
               down = static_cast<double>(flow.height) / box.height;
  const auto seen = [&](cv::Point2d at) {
    return cv::Point2f(static_cast<float>((at.x - box.x + .5) * across - .5),
                       static_cast<float>((at.y - box.y + .5) * down - .5));
  };
  const auto held = [&](cv::Point2d at) { return holds(box.size(), at - cv::Point2d(box.x, box.y)); };
  std::vector<FlowPin> out;
  for (const PlacedPin& pin : pins)
    if (pin.from == from && pin.to == to && held(pin.at) && held(pin.goes))
      out.push_back({.at = seen(pin.at),
                     .goes = seen(pin.goes),
                     .reach = static_cast<float>(std::max(kLeastReach, pin.reach * across))});
  return out;
}

}  // namespace freshet::synth::stills
