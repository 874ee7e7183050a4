// synth/stills/stills_page.h — what was decided, on one page for a person: graphs with thumbnails, paths, sequences.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/plan.h"

namespace freshet::synth::stills {

struct PageFacts {
  std::string title;
  std::string video;  // address of the animation from the page; empty: none
  std::vector<std::string> names;
  std::vector<std::string> notices;
  double seconds = 0;  // of the animation
};

/// An HTML page that needs no other file but the video. For each region: its stills laid out so that like
/// ones lie near (classical scaling of their distances), edges of the graph, paths in colour with the lines
/// for an edits file that refuse or turn them, and the sequence with its times.
/// small   the stills, CV_8UC3. sheet   of the regions, CV_8UC3; may be empty.
std::string stills_page(const Plan& plan, const std::vector<cv::Mat>& small, const cv::Mat& sheet,
                        const PageFacts& facts);

/// A path and its reverse once.
std::vector<Path> one_way(const std::vector<Path>& paths);

/// Places in the plane whose distances are as near to the table's as two dimensions allow; -1..1.
std::vector<cv::Point2d> laid_out(const Square<double>& distances);

}  // namespace freshet::synth::stills
