#include "synth/takes/pace.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "synth/animate/motion/motion_field.h"
#include "synth/animate/placement/assigned.h"
#include "synth/judging/usual.h"

namespace freshet::synth::takes {

double filmed_speed(const store::Snapshot& snapshot, const vision::Settings& settings,
                    const query::Assignment& assignment, const cv::Mat& matte) {
  const cv::Mat motion = animate::motion_field(
      snapshot, settings, animate::placement_from(assignment, snapshot), assignment.picture);
  std::vector<cv::Mat> parts;
  cv::split(motion, parts);
  cv::Mat speed;
  cv::magnitude(parts[0], parts[1], speed);
  return cv::mean(speed, matte > 127)[0];
}

double factor_of(std::string_view pace, std::string_view kind, double filmed, cv::Size picture) {
  const bool itself = pace == "auto";
  if (itself && std::ranges::find(judging::kKinds, kind) == judging::kKinds.end()) return 1;
  const double asked = judging::speed_of(kind, itself ? "natural" : pace, picture) / std::max(filmed, 1e-3);
  return std::clamp(itself ? std::sqrt(asked) : asked, 0.05, 20.0);
}

Paced paced(const store::Snapshot& snapshot, const vision::Settings& settings,
            const query::Assignment& assignment, const cv::Mat& matte, std::string_view pace,
            std::string_view kind, bool speed_asked) {
  if (pace == "auto" && speed_asked) return {};
  const double filmed = filmed_speed(snapshot, settings, assignment, matte);
  return {.factor = factor_of(pace, kind, filmed, matte.size()), .filmed = filmed};
}

}  // namespace freshet::synth::takes
