// synth/stills/region.h — parts of a scene that go through the stills each in its own order.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::stills {

enum class RegionKind {
  kIndependent,  // moves by itself (IAR), or beside a reference (SIAR)
  kSlow,         // varies a little: fades slowly from still to still
  kStanding,     // one still's, throughout
};
std::string to_string(RegionKind kind);  // "independent", "slow", "standing"

struct Region {
  std::string name;
  RegionKind kind = RegionKind::kIndependent;
  cv::Mat mask;        // CV_8U of the work size, 255 in it
  std::string parent;  // of a part that a large region was split into; empty: of none
};

/// How much of each pixel is whose: CV_32F of the masks' size, a plane a region, none for standing ones.
/// What their sum leaves to 1 is the standing still's. Each mask is grown by `grown` px, then falls off to
/// nothing over `feather` px; where several meet they share, but a slow one takes what the others leave.
/// Source   Lin et al. 2007, Sec. 4 (regions dilated by a few pixels, feathered linearly).
std::vector<cv::Mat> region_weights(const std::vector<Region>& regions, double grown, double feather);

}  // namespace freshet::synth::stills
