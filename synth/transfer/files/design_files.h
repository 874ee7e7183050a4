// synth/transfer/files/design_files.h — a designed animation from files: a mask and a motion field per frame.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// Masks and motion fields, paired in order, whatever their numbers.
///
/// alpha  a folder or a pattern (%05d, ####) of pictures, or a video. Where any frame is transparent
///        anywhere, the mask is the alpha channel; else it is the luminance.
/// flow   a folder or a pattern of .flo or .exr fields, px per frame (media/picture/motion_file.h). Of a
///        folder that holds both, the .flo.
class DesignFiles {
 public:
  /// Lists what there is. frames: only so many of the first, 0 for all.
  /// Throws Error{kInput} naming the file: nothing there, a number is missing, or, where all frames are asked
  /// for, one sequence longer than the other.
  DesignFiles(const std::filesystem::path& alpha, const std::filesystem::path& flow, int frames = 0);
  DesignFiles(DesignFiles&&) noexcept;
  ~DesignFiles();

  /// Reads all of it once. Throws Error{kInput} naming file, fault and remedy: unreadable, a size other than
  /// the first frame's, flow that is not finite or unknown (above 1e9), masks that are black in all frames;
  /// Error{kCancelled} when stopped. Then the rest of this class may be used.
  void check(const std::function<void(std::size_t done, std::size_t of)>& progress = {},
             const std::stop_token& stop = {});

  int frames() const;
  cv::Size size() const;
  bool full() const;                // white everywhere in all frames: the fluid has no outline
  int empty_frames() const;         // black everywhere
  const std::string& hash() const;  // of all masks and fields

  /// alpha CV_32F, flow CV_32FC2. Cheapest in order.
  TargetFrame read(int frame);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace freshet::synth::transfer
