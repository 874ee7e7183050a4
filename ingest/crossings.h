// crossings.h — what crosses a clip and is not its fluid: people, animals, boats, birds.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::ingest {

/// Finds things that come by and go: that are for a while of another luma than their place has else, move otherwise
/// than it does, go straight and farther than their side (the root of their area), and look the same along their way.
/// Fluids have regions of each of the first three; none keeps its look. Where such a thing is found it is followed by
/// its look as well, before and after.
///
/// It is looked for in half-overlapping windows of 72 frames, of at most 256 px, some 12.5 a second (every second one
/// of 25). Not seen: what stands for most of a window, which belongs to the place; what is smaller than a thousandth of
/// the frame or larger than a fifth; anything in fewer than 13 of these frames, or where their shorter side is below
/// 48 px. How much is found: docs/measurements/ingest.md.
/// Memory: 25 MB at 16:9, 43 for a square. Cost: 3 ms a frame of 25 a second, one thread.
class CrossingFinder {
 public:
  CrossingFinder(cv::Size source, double fps);
  void add(const cv::Mat& luma);  // CV_8U, source size; frame by frame
  /// 255 where something crossed, CV_8U at source size, with a rim around it; empty where nothing did.
  cv::Mat finish();

 private:
  static constexpr int kSide = 256;           // px
  static constexpr double kRate = 12.5;       // frames a second, about
  static constexpr std::size_t kWindow = 72;  // frames
  void search();

  cv::Size source_, size_;
  int step_;  // frames
  int frames_ = 0;
  std::size_t unseen_ = 0;       // frames since the last search
  std::vector<cv::Mat> window_;  // CV_8U
  std::vector<cv::Mat> flows_;   // CV_32FC2, px, from each of its frames to the next
  cv::Mat crossed_;              // CV_8U
};

}  // namespace freshet::ingest
