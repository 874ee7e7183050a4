// bench/flowlines/followed.h — how well the fluid of an edited film goes along the lines that were drawn for it.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/edited_view.h"
#include "synth/flowlines/lines/flow_line.h"

namespace freshet::bench {

/// Means over places along the edited lines, each weighted by how fast the clip goes at the input line's place.
struct Followed {
  double degrees = 0;       // between the film's mean flow and the edited line
  double clip_degrees = 0;  // between the clip's mean flow and the input line, where the same particles are
  /// |log2| of the ratio of speeds, film by clip times data-speed, each along its own line. By flow, which is smooth
  /// and so sees the neighbourhood's motion, too; and by following a ribbon of kRibbonPx about the line, which does
  /// not.
  double flow_speed = 0, ribbon_speed = 0;
  double slower = 0;  // mean log2 of the ratio by the ribbon, with its sign: below 0 the film is slower
  int places = 0;
};

inline constexpr double kRibbonPx = 8;

/// film, clip   CV_8UC3, of one size: what was made, and what it was made of.
/// inputs       lines of the clip; edited   of the film, none of which moves; named after their inputs.
/// shown        CV_8U, empty: everywhere; else only where it is not 0.
Followed followed(const std::vector<cv::Mat>& film, const std::vector<cv::Mat>& clip,
                  const std::vector<synth::flowlines::FlowLine>& inputs,
                  const std::vector<synth::flowlines::FlowLine>& edited,
                  synth::flowlines::Correspondence correspondence, const cv::Mat& shown = {});

/// Lines bent together as the picture would be, so that they do not cross: straight at the matte's middle, and turned
/// the more the further up or down the mean way they lie, by `degrees` at most; a wide stream by less.
std::vector<synth::flowlines::FlowLine> bent(const std::vector<synth::flowlines::FlowLine>& lines,
                                             double degrees);

}  // namespace freshet::bench
