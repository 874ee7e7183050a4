// synth/matte/matte.h — a matte from marks: where a picture's fluid is, with a soft edge.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/matte/hard_region.h"
#include "synth/matte/soft_edge.h"

namespace freshet::synth::matte {

struct MatteOptions {
  RegionOptions region{};
  EdgeOptions edge{};
};

struct MadeMatte {
  cv::Mat alpha;        // CV_8U, the picture's size; 255 where all is fluid
  double fraction = 0;  // mean of alpha, 0..1
  double region_s = 0, edge_s = 0;
  std::vector<std::string> notices;  // for a person
};

/// picture  CV_8UC3. marks   of its size.
/// where    what was marked, for messages.
/// Throws   Error{kInput} as hard_region, and when no pixel comes out as fluid; Error{kCancelled}.
MadeMatte make_matte(const cv::Mat& picture, const Marks& marks, const MatteOptions& options,
                     const std::string& where, std::stop_token stop = {});

/// For the eye, two by two: picture, marks (green fluid, red background), matte, cut-out on a chequered ground; cropped
/// to the matte and its marks, each at most 1280 px wide, so that edges are seen at full size, with words below.
/// CV_8UC3.
cv::Mat matte_sheet(const cv::Mat& picture, const Marks& marks, const cv::Mat& alpha);

}  // namespace freshet::synth::matte
