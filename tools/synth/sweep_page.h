// tools/synth/sweep_page.h — the animations of a sweep beside each other: one picture, and one page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::tools {

/// What is shown of one point.
struct SweptAnimation {
  std::string number, title;  // "01"; "speed 2, without strokes"
  std::string result;         // in words: what came out, against the first
  /// Names of files in the page's folder: the animation, what the page plays of it, and which patches it shows.
  std::string file, video, assignment;
  std::string command;     // that makes it alone
  int same_as = -1;        // whose frames these are; -1: its own
  double energy = 0;       // of its labelling, by its own weights
  double gap = 0;          // infinite when no bound is known
  double changed = -1;     // fraction of pieces whose patch is not the first point's; negative: other pieces
  double difference = -1;  // mean, levels of 255, of the frame below to the first point's, in the fluid
  std::size_t clips = 0;   // whose patches are shown
  cv::Mat frame;           // one of it, CV_8UC3; empty where same_as
};

/// What they have in common.
struct SweepWords {
  std::string title;              // "Sweep of fall.png"
  std::vector<std::string> axes;  // what is varied and what that is, a sentence each
  std::string still;              // its file's name
  cv::Size size;                  // of the picture, px
  cv::Rect region;                // what of it is shown: the fluid
  double fps = 25;
  int frame = 0;  // the one on the sheet
};

/// The still, then a frame of each animation that is its own, cropped, each with its words below; a legend below all.
/// CV_8UC3; cells of at most 480 px, in a grid that is about as wide as high.
cv::Mat sweep_sheet(const SweepWords& words, const cv::Mat& still,
                    const std::vector<SweptAnimation>& animations);

/// A page of its own: all that it names lies beside it. Its videos show the same moment, cropped to the fluid until the
/// whole is asked for.
std::string sweep_page(const SweepWords& words, const std::vector<SweptAnimation>& animations);

}  // namespace freshet::tools
