// include/freshet/footage.h — what a store keeps of one clip: frames, motion, columns of its patches, cells.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/store.h"

namespace freshet {

/// One clip of a store. Holds the store, and lends nothing: every Mat owns its samples. Copies share; there is no empty
/// one. Safe from many threads. Mats of several frames have three dimensions: frames x rows x columns.
/// Every read throws Error{kDamaged} naming the record, and Error{kUsage} for frames that are not there.
class Footage {
 public:
  /// clip   its name. Throws Error{kNotFound}.
  Footage(const Store& store, const std::string& clip);
  Footage(const Footage&) = default;  // and no moves: they would leave an empty one
  Footage& operator=(const Footage&) = default;

  Clip clip() const;
  /// FFmpeg's name of the frames' layout: yuv420p, ...
  std::string pixel_format() const;

  /// Samples as the decoder gave them, to the bit: a Mat for each plane, CV_8U or CV_16U.
  /// Cost, here and below   some 400 MB of samples a second and core; all threads.
  std::vector<cv::Mat> planes(std::uint32_t first, std::uint32_t count) const;
  /// CV_8UC3 as a player shows it, not rotated.
  cv::Mat bgr(std::uint32_t first, std::uint32_t count) const;
  /// CV_8U luminance, full range.
  cv::Mat luma(std::uint32_t first, std::uint32_t count) const;
  /// CV_32FC2, px of the frame from one frame to the next, x right, y down; a value for each flow_step() px. There is
  /// one less than frames.
  cv::Mat flow(std::uint32_t first, std::uint32_t count) const;
  int flow_step() const;
  /// Mean luminance over time, CV_8U of the frame's size.
  cv::Mat average() const;

  /// Names of the columns that this clip has: frame.time (s), flow.rate (pairs of frames a second), patch.variant,
  /// patch.x and patch.y (px, upper left corner in the variant's frame), patch.motion (px/s, x right, y down),
  /// patch.coverage
  /// (0 to 1), patch.words (81 visual words, once there is an index).
  std::vector<std::string> columns() const;
  /// A row for each frame, pair of frames or patch; a column for each value of a row. CV_8U, CV_16U, CV_32F or CV_64F.
  /// Throws Error{kNotFound}.
  cv::Mat column(const std::string& name) const;

  /// Names of the maps of cells: motion, life, standing, texture.0, ... (one a scale).
  std::vector<std::string> cell_maps() const;
  /// Rows x columns of cells, x values: three dimensions, CV_32F. docs/format.md says what the values are.
  /// Throws Error{kNotFound}.
  cv::Mat cells(const std::string& name) const;

  /// For the library's own use.
  struct Impl;

 private:
  std::shared_ptr<const Impl> impl_;
};

/// One way in which a store looks at its clips: scaled, then turned, then flipped left to right.
struct PatchVariant {
  double scale = 1;
  double rotation_deg = 0;  // counter-clockwise as seen
  bool flip = false;
};
/// What the values of patch.variant number.
std::vector<PatchVariant> variants(const Store& store);

}  // namespace freshet
