// synth/matte/soft_edge.h — how much of each pixel beside a region's edge is fluid.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "synth/matte/marks.h"

namespace freshet::synth::matte {

enum class Edge {
  kNone,             // the region as it is
  kGuided,           // He, Sun and Tang 2010: the region filtered along the picture's own edges
  kInformationFlow,  // Aksoy, Aydin and Pollefeys 2017: alpha that flows between pixels of like colour
};
/// "none", "guided", "information-flow". Throws Error{kUsage}.
Edge parse_edge(const std::string& name);
const char* to_string(Edge edge);

struct EdgeOptions {
  Edge edge = Edge::kInformationFlow;
  /// The band in which alpha is found, half of it to either side of the region's edge. 0: of the picture's
  /// longer side 8 %, guided 2 %.
  double width_px = 0;
  double guided_radius = 0.25;  // of the guided filter, in widths of the band
  double guided_eps = 1e-3;     // contrast (variance of 0..1) below which a guided edge is smoothed
  int max_pixels = 100'000;     // of the copy that information flow works on: some 30 us per pixel
};

/// The band's width, px, for a picture of this size.
double band_width(const EdgeOptions& options, cv::Size size);

/// The trimap: 0 and 255 where region or marks are sure, 128 in the band.
cv::Mat trimap_of(const cv::Mat& region, const Marks& marks, double width_px);

/// Alpha, CV_8U: the region's own values outside of the band, and the marks' where there are any. Information
/// flow works on the part of the picture that holds the band, reduced to max_pixels; what comes back is
/// fitted to the picture's own edges by a guided filter.
/// What is below 8 is 0.
/// picture  CV_8UC3.
/// region   CV_8U, 0 or 255.
cv::Mat soft_edge(const cv::Mat& picture, const cv::Mat& region, const Marks& marks,
                  const EdgeOptions& options);

}  // namespace freshet::synth::matte
