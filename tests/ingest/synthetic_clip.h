// synthetic_clip.h — clips whose motion is known, written without loss.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::ingest {

struct SyntheticClip {
  cv::Size size{192, 144};
  int frames = 40;
  int fps = 25;
  cv::Rect moving{24, 24, 144, 96};  // in which a texture scrolls
  cv::Vec2d velocity{1.0, 0.5};      // of the texture, px per frame
  cv::Vec2d pan{0, 0};               // of the whole scene, px per frame
  double jitter = 0;                 // px, uniform +-, of the whole scene
  int cut_at = 0;                    // frame at which another scene begins; 0: none
  bool changing = false;             // the texture turns into another all the time, as a fluid does
  bool crossed = false;   // somebody in light clothes and a dark coat walks through, a px per frame
  int start = 0;          // moment of the first frame
  cv::Vec2d shift{0, 0};  // px, of the whole scene at all times
  bool coarse = false;    // the scene has large forms too, as real ones have
  std::uint64_t seed = 1;
};

/// Frames, CV_8U.
std::vector<cv::Mat> render(const SyntheticClip& clip);

/// Writes the frames to a file of a lossless kind (.mkv) or a sequence pattern.
void write_clip(const std::filesystem::path& path, const SyntheticClip& clip);

}  // namespace freshet::ingest
