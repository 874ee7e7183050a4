// bench/kind/outlines.h — outlines of the fluid in stills and clips, drawn by eye: a text file, and the stills it
// speaks of.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

/// One line of the file (bench/kind/outlines.txt says how it is written).
struct Outlined {
  std::vector<std::string> classes;  // the fluid's; several: each is right
  std::string motion;
  std::string file;                                // below the footage
  std::vector<int> percents;                       // which frames, in percent of the clip
  std::vector<std::vector<cv::Point2d>> outlines;  // 0..1; none: everywhere

  bool simulated() const { return file.starts_with("simulated/"); }
  /// The file; of simulated clips those of all seeds.
  std::string scene() const { return simulated() ? file.substr(0, file.rfind('/')) : file; }
  /// 255 inside, CV_8U.
  cv::Mat matte(cv::Size size) const;
};

/// Throws Error{kInput} naming file and line for what it cannot read.
std::vector<Outlined> read_outlines(const std::filesystem::path& path);

struct Still {
  cv::Mat picture, matte;  // CV_8UC3, CV_8U
};
/// The frames spoken of, of at most `side` px; of a picture itself, once; of `simulated/CLIP/SEED`, the first, with its
/// alpha.
std::vector<Still> stills_of(const Outlined& outlined, const std::filesystem::path& footage, int side);

}  // namespace freshet::bench
