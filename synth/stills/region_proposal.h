// synth/stills/region_proposal.h — regions proposed from what varies, and what varies together.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/region.h"

namespace freshet::synth::stills {

struct RegionProposalOptions {
  int side = 320;      // px, longer side of the copies that are looked at
  double moves = 0.2;  // of the strongest variation: what varies more moves
  double together =
      0.75;  // of two places' tables of distances (correlation, 0..1): above it one order serves both
  double apart = 0.5;   // below it two parts of one place are separate, where a valley lies between them
  double valley = 0.5;  // of the lower of two peaks: a valley is not above it
  int most = 12;        // regions
};

struct RegionProposal {
  std::vector<Region>
      regions;        // independent ones from left to right; then "slow", where there is any; not what stands
  cv::Mat variation;  // CV_32F, of 255: standard deviation over the stills, at the copies' size
  std::vector<std::string> notices;
};

/// small   the stills at work size, CV_8UC3, aligned and levelled.
/// What varies by more than `moves` of the strongest is cut into pieces that hang together; a piece in which
/// two peaks of variation have a valley between them and tables of distances of their own becomes two;
/// pieces whose tables agree become one region, wherever they lie; so do three pieces or more that touch: from
/// each to the next it is no more than .04 of the longer side.
/// Throws   Error{kInput} when nothing moves.
/// Source   ours. Lin et al. 2007, Sec. 4 leave it to the user: stills so far apart show no motion to
///          segment by. Which
///          stills are alike they do show, place by place. (Agreement of tables: Mantel 1967.)
/// Cost     .3 s for 14 stills.
RegionProposal propose_regions(const std::vector<cv::Mat>& small, const RegionProposalOptions& options = {});

/// Standard deviation over the stills, CV_32F, of 255.
cv::Mat variation_of(const std::vector<cv::Mat>& stills);

/// For a person: the still with its regions outlined, tinted and named, beside the variation. CV_8UC3.
cv::Mat region_sheet(const cv::Mat& still, const std::vector<Region>& regions, const cv::Mat& variation);

}  // namespace freshet::synth::stills
