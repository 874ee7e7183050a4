#include "synth/takes/pace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "synth/animate/motion/motion_field.h"
#include "synth/animate/placement/assigned.h"
#include "synth/judging/usual.h"

namespace freshet::synth::takes {
namespace {

constexpr double kSlowest = 0.1;  // of the mean: a slower clip counts as this

/// Filmed::usual. A clip counts by its pieces whose middles lie in the matte.
/// speed  CV_32F, px/s.
double usual_of(const animate::Placement& placement, const cv::Mat& speed, const cv::Mat& matte,
                double mean) {
  struct OfClip {
    int pieces = 0;
    double speeds = 0;
  };
  std::map<store::ClipId, OfClip> clips;
  const cv::Rect picture({}, matte.size());
  const cv::Point half(placement.side / 2, placement.side / 2);
  int pieces = 0;
  for (const animate::PlacedPatch& placed : placement.patches) {
    const cv::Point middle = placement.piece_scale * cv::Point2d(placed.piece + half);
    if (!picture.contains(middle) || matte.at<std::uint8_t>(middle) <= 127) continue;
    OfClip& of = clips[placed.clip];
    ++of.pieces, ++pieces;
    of.speeds += speed.at<float>(middle);
  }
  if (pieces == 0 || mean <= 0) return mean;
  double logs = 0;
  for (const auto& [clip, of] : clips)
    logs += of.pieces * std::log(std::max(of.speeds / of.pieces, kSlowest * mean));
  return std::exp(logs / pieces);
}

}  // namespace

Filmed filmed_speed(const store::Snapshot& snapshot, const vision::Settings& settings,
                    const query::Assignment& assignment, const cv::Mat& matte) {
  const animate::Placement placement = animate::placement_from(assignment, snapshot);
  const cv::Mat motion = animate::motion_field(snapshot, settings, placement, assignment.picture);
  std::vector<cv::Mat> parts;
  cv::split(motion, parts);
  cv::Mat speed;
  cv::magnitude(parts[0], parts[1], speed);
  const double mean = cv::mean(speed, matte > 127)[0];
  return {.mean = mean, .usual = usual_of(placement, speed, matte, mean)};
}

double factor_of(std::string_view pace, std::string_view kind, const Filmed& filmed, cv::Size picture) {
  const double mean = std::max(filmed.mean, 1e-3);
  double goes = 0;
  if (pace == "auto") {
    if (std::ranges::find(judging::kKinds, kind) == judging::kKinds.end()) return 1;
    const double as_filmed = kind == "clouds" || kind == "smoke" ? std::max(filmed.usual, 1e-3) : mean;
    goes = std::sqrt(as_filmed * judging::speed_of(kind, "natural", picture));
  } else {
    goes = judging::speed_of(kind, pace, picture);
  }
  return std::clamp(goes / mean, 0.05, 20.0);
}

Paced paced(const store::Snapshot& snapshot, const vision::Settings& settings,
            const query::Assignment& assignment, const cv::Mat& matte, std::string_view pace,
            std::string_view kind, bool speed_asked) {
  if (pace == "auto" && speed_asked) return {};
  const Filmed filmed = filmed_speed(snapshot, settings, assignment, matte);
  return {.factor = factor_of(pace, kind, filmed, matte.size()), .filmed = filmed};
}

}  // namespace freshet::synth::takes
