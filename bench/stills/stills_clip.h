// bench/stills/stills_clip.h — frames of a real clip, reduced, for the benches of synth/stills.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

struct StillsClip {
  std::string name;
  std::vector<cv::Mat> frames;  // CV_8UC3
  double fps = 25;
};

/// width   px; sides become multiples of 16. most   frames.
StillsClip read_stills_clip(const std::filesystem::path& path, int width, int most);

/// A ready-made clip of the simulator (smoke, fire, ...), seed 3, 25 frames/s.
StillsClip simulated_stills_clip(const std::string& scene, cv::Size size, int frames);

/// Ten clips of a fixed camera below the footage folder: flames, falls, sea, clouds, smoke.
std::vector<std::filesystem::path> stills_clips(const std::filesystem::path& footage);

/// CV_8U, 255 where the clip varies over time by more than a fifth of its strongest variation.
cv::Mat moving_mask(const std::vector<cv::Mat>& frames);

}  // namespace freshet::bench
