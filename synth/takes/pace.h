// synth/takes/pace.h — how fast an animation plays where a person says a pace, or nothing.
#pragma once

#include <string_view>

#include <opencv2/core.hpp>

#include "query/labelling/assignment.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::synth::takes {

/// How fast what is assigned goes inside a matte, as it was filmed, px/s.
struct Filmed {
  double mean = 0;
  /// The geometric mean over clips of their pieces' means; a clip counts as a tenth of `mean` at least.
  double usual = 0;
};

/// matte    CV_8U, the assigned picture's size.
/// Throws   as animate::placement_from and animate::motion_field.
Filmed filmed_speed(const store::Snapshot& snapshot, const vision::Settings& settings,
                    const query::Assignment& assignment, const cv::Mat& matte);

/// The factor of playing, .05 to 20, at which what was filmed has a pace in the mean.
/// pace   "slow", "natural" or "fast": as the kind goes (judging::speed_of). "auto": half-way, in octaves, from as
///        filmed to natural; 1 where the kind is none of judging::kKinds. As filmed is the mean; of clouds and smoke
///        the usual, for their clips differ by octaves, and a mean is that of the fastest. Patches and kind each tell
///        little of a picture's own speed, and both together more: with a direction alone .90 octaves off for 1.11 as
///        filmed (docs/measurements/motion.md).
double factor_of(std::string_view pace, std::string_view kind, const Filmed& filmed, cv::Size picture);

struct Paced {
  double factor = 1;
  Filmed filmed{};  // 0: nobody needed to know
};
/// How what is assigned plays at a pace. "auto" yields to speeds that are asked.
/// Throws   as filmed_speed.
Paced paced(const store::Snapshot& snapshot, const vision::Settings& settings,
            const query::Assignment& assignment, const cv::Mat& matte, std::string_view pace,
            std::string_view kind, bool speed_asked);

}  // namespace freshet::synth::takes
