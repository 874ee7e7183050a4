// synth/animate/frame_sheet.h — an animation on one page: the picture, then frames evenly spread over it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

struct SheetOptions {
  double fps = 25;
  std::int64_t first_number = 0;  // of the frames, as they are numbered for a person
  int first = 0;                  // frame of the animation that is added first
  int shown = 8;                  // frames, beside the picture itself
  int width_px = 480;             // of each
};

/// Collects frames as they are rendered and lays them out in a grid, cropped to where the fluid is, with a line below
/// each and a legend below all.
class FrameSheet {
 public:
  /// matte    CV_8U: the sheet shows the region around what is above 0.
  /// frames   that will be added.
  FrameSheet(const cv::Mat& picture, const cv::Mat& matte, int frames, const SheetOptions& options = {});
  void add(const cv::Mat& frame);  // in order; CV_8UC3
  /// CV_8UC3, three columns.
  cv::Mat draw() const;
  /// Of the picture, what is shown.
  cv::Rect region() const { return region_; }

 private:
  struct Cell {
    cv::Mat picture;
    std::string words;
  };
  cv::Mat reduced(const cv::Mat& picture) const;

  SheetOptions options_;
  cv::Rect region_;
  cv::Size picture_;
  int frames_ = 0, shown_ = 0, seen_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace freshet::synth::animate
