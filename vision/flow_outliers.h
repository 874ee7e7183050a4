// vision/flow_outliers.h — which frames' flow is not to be believed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace freshet::vision {

enum class FlowOutlier : std::uint8_t {
  kNone = 0,
  kFast = 1,   // a cut, a flash, a gap: what is followed through it is lost
  kStill = 2,  // a repeated frame: nothing is lost, time goes on
};

/// By flow frame, from the mean speed of each, px a frame: kStill where it is less than a tenth of one of the two
/// before, and of one of the two after (at the ends, of those that there are); kFast where it is more than 2.5 times
/// the median of those that are not still, and .25 px more.
/// Cost     O(frames).
std::vector<FlowOutlier> flow_outliers(std::span<const float> mean_speed_px);

}  // namespace freshet::vision
