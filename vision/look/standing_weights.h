// vision/look/standing_weights.h — made by bench/takes/holds.py --weights; not edited by hand.
#pragma once

#include <array>
#include <string_view>

namespace freshet::vision {

struct StandingWeight {
  std::string_view figure;
  double mean, deviation;  // over what was learned from
  double speaks_for;       // per deviation
};

inline constexpr double kStandingOffset = -1.213, kLeastScore = 0.05, kFarthestFigure = 4;
inline constexpr std::array<StandingWeight, 10> kStandingWeights{{
    {"beside", 0.1362, 0.1951, 0.4106},
    {"edge", 0.1734, 0.2667, 0.3767},
    {"background", -1.605, 1.499, 0.2045},
    {"nearby", -0.2315, 0.4546, 0.06929},
    {"detail", 0.2893, 1.212, 0.3357},
    {"height", 0.02399, 0.3012, 0.2161},
    {"near_dark", 0.01908, 0.4237, 0.2003},
    {"near_unlike", 0.1728, 0.2622, 0.2007},
    {"near_background", 0.04395, 0.2146, -0.0724},
    {"near_hue", 0.3911, 0.5709, 0.2021},
}};

}  // namespace freshet::vision
