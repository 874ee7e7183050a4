// synth/flowlines/footage.h — a clip's frames, held in memory: what is shown again and again.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::flowlines {

struct Footage {
  std::string name;             // for messages
  std::vector<cv::Mat> frames;  // CV_8UC3, all of one size
  double fps = 25;
  std::vector<std::string> notices{};  // for a person

  cv::Size size() const { return frames.empty() ? cv::Size() : frames.front().size(); }
  int count() const { return static_cast<int>(frames.size()); }
};

}  // namespace freshet::synth::flowlines
