// synth/flowlines/streamlines.h — evenly spaced lines along a field: flow lines found without drawing.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/lines/flow_line.h"

namespace freshet::synth::flowlines {

struct StreamlineOptions {
  double spacing_px = 12;     // between neighbouring lines
  double min_gap = 0.5;       // a line ends where it comes nearer to another than this share of the spacing
  double min_length_px = 24;  // shorter lines are left out
  int max_lines = 2000;
};

/// Lines from where the fluid enters the matte to where it leaves it, longest neighbours first, named "l1", "l2", ...
///
/// field    CV_32FC2: only its direction counts; smooth it first.
/// matte    CV_8U: lines stay where it is above 127.
/// Returns  none when the matte holds no line that is long enough.
/// Source   Jobard and Lefer 1997, "Creating evenly-spaced streamlines of arbitrary density". The paper of Bhat et al.
///          leaves lines to the artist and wishes for this.
std::vector<FlowLine> evenly_spaced(const cv::Mat& field, const cv::Mat& matte,
                                    const StreamlineOptions& options = {});

/// A field smoothed within a matte: what lies beyond it counts for nothing.
cv::Mat smoothed(const cv::Mat& field, const cv::Mat& matte, double sigma_px);

}  // namespace freshet::synth::flowlines
