// synth/stills/still_pins.h — pins of an edits file, laid onto the stills.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/between/flow_pins.h"
#include "synth/stills/edits.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {

/// A pin whose stills are known. The one that is earlier in the set comes first, whichever way it was said.
struct PlacedPin {
  std::string name;      // for a person: "pin 2 (a.png to b.png)"
  int from = 0, to = 0;  // from < to
  cv::Point2d at, goes;  // px of the set's pictures
  double reach = 0;      // px of them
};

/// Throws   Error{kInput} naming the pin, the fault and the remedy: no such still, one still twice, a place
///          outside the file or the part of it that aligning left, two pins on one point, two that contradict
///          each other: points nearer than 1/120 of the longer side in either still whose moves differ by more
///          than they are apart.
std::vector<PlacedPin> placed_pins(const std::vector<StillPin>& pins, const StillSet& set);

/// Those of a pair of stills that a box holds, both ends, as its flow of that size sees them. At least 4 px of reach.
std::vector<FlowPin> flow_pins(const std::vector<PlacedPin>& pins, int from, int to, const cv::Rect& box,
                               cv::Size flow);

}  // namespace freshet::synth::stills
