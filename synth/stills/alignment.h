// synth/stills/alignment.h — stills taken from the hand, brought onto each other.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet::synth::stills {

struct AlignmentOptions {
  int side = 1024;             // px, longer side of the copies that are compared
  double still_px = 0.6;       // of the copies: where all corners move less, the camera stood still
  double min_agreement = 0.6;  // of what stands still, 0..1 (correlation): below it the stills are refused
  double max_cut = 0.35;       // of either side, that cropping may cost
};

/// How the stills lie on the first of them.
struct Alignment {
  /// 3 x 3, CV_64F, of the full size: what lies at p in the reference lies at map(p) in the still.
  std::vector<cv::Mat> maps;
  cv::Rect common;        // px of the reference: what all stills show
  bool tripod = false;    // nothing moved: the maps are not to be applied
  bool unsure = false;    // too few stills agree in anything: taken as from a tripod
  double largest_px = 0;  // how far a corner moves, px of the stills
};

/// Features, a similarity or, where it explains clearly more, a homography by RANSAC, then ECC refines it.
/// Features that move with the fluid are outliers, and ECC sees the half of the places that differ least.
/// pictures   of one size, CV_8UC3 or CV_16UC3. names   for messages.
/// Throws     Error{kInput} naming the still and the reason: nothing fits, no overlap; Error{kCancelled}.
/// Cost       .2 CPU seconds a still.
Alignment find_alignment(const std::vector<cv::Mat>& pictures, const std::vector<std::string>& names,
                         const AlignmentOptions& options = {}, const Job& job = {});

/// The stills as the reference sees them, cut to what is common; of cubic interpolation. Replaces them one
/// by one.
void align(std::vector<cv::Mat>& pictures, const Alignment& alignment);

/// Factors of blue, green and red by which each still comes to the level of the middle one, found where the
/// stills hardly differ otherwise. small   CV_8UC3 of one size, aligned.
/// All 1 where less than 2 % of the picture stands still.
std::vector<cv::Vec3d> find_levels(const std::vector<cv::Mat>& small);
/// Applies them where one is off 1 by more than 0.4 %; returns how many stills were changed.
int level(std::vector<cv::Mat>& pictures, const std::vector<cv::Vec3d>& factors);

}  // namespace freshet::synth::stills
