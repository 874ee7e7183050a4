// synth/stills/still_set.h — the stills of a scene, from a folder of pictures.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"

namespace freshet::synth::stills {

/// Stills of one size and depth, in natural order of their names, which says nothing of time.
struct StillSet {
  std::vector<std::string> names;    // of the files, without their folder
  std::vector<cv::Mat> pictures;     // all CV_8UC3 or all CV_16UC3, sRGB code, upright
  std::vector<std::string> notices;  // for a person: what was left out, and why

  cv::Size file_size;  // px, of the upright files
  /// By still: what lies at p in its upright file lies at from_file(p) in its picture, px, (0, 0) being the middle of
  /// the upper left pixel of either.
  std::vector<cv::Matx33d> from_file{};

  int count() const { return static_cast<int>(pictures.size()); }
  cv::Size size() const { return pictures.front().size(); }
};

inline constexpr int kMinSide = 64, kMaxStills = 200;

/// Reads the pictures of a folder. EXIF orientation is honoured. What is no picture, a picture that is
/// damaged and a picture equal to an earlier one are left out, and told; where one has 16 bits, all have.
/// Throws   Error{kInput}: no folder, fewer than two stills left, above kMaxStills, unlike sizes, a side
///          below kMinSide.
/// Cost     the stills are held: 3 bytes a pixel, 6 of 16 bits. Decoded on all threads.
/// max_side   px: larger stills are reduced by area; 0: none are.
StillSet read_stills(const std::filesystem::path& folder, int max_side = 0, const Job& job = {});

/// Each as CV_8UC3 of at most max_side px, by area; larger never.
std::vector<cv::Mat> reduced(const std::vector<cv::Mat>& pictures, int max_side);
cv::Size reduced_size(cv::Size size, int max_side);

}  // namespace freshet::synth::stills
