// synth/takes/pace.h — how fast an animation plays where a person says a pace, or nothing.
#pragma once

#include <string_view>

#include <opencv2/core.hpp>

#include "query/labelling/assignment.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::synth::takes {

/// Mean speed inside a matte of what is assigned, as it was filmed, px/s.
/// matte    CV_8U, the assigned picture's size.
/// Throws   as animate::placement_from and animate::motion_field.
double filmed_speed(const store::Snapshot& snapshot, const vision::Settings& settings,
                    const query::Assignment& assignment, const cv::Mat& matte);

/// The factor of playing, .05 to 20, at which what goes at `filmed` px/s has a pace.
/// pace   "slow", "natural" or "fast": as the kind goes (judging::speed_of). "auto": half-way, in octaves, from
///        `filmed` to natural; 1 where the kind is none of judging::kKinds. Patches and kind each tell little of a
///        picture's own speed, and both together more: with a direction alone .90 octaves off for 1.11 as filmed
///        (docs/measurements/motion.md).
double factor_of(std::string_view pace, std::string_view kind, double filmed, cv::Size picture);

struct Paced {
  double factor = 1;
  double filmed = 0;  // px/s; 0: nobody needed to know
};
/// How what is assigned plays at a pace. "auto" yields to speeds that are asked.
/// Throws   as filmed_speed.
Paced paced(const store::Snapshot& snapshot, const vision::Settings& settings,
            const query::Assignment& assignment, const cv::Mat& matte, std::string_view pace,
            std::string_view kind, bool speed_asked);

}  // namespace freshet::synth::takes
