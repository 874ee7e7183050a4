// stored/clip_frames.h — a clip's frames out of a store, as the decoder gave them.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame/frame.h"
#include "store/store.h"

namespace freshet::stored {

/// Whole frames of one clip, in all their planes. Holds the snapshot.
class ClipFrames {
 public:
  /// Throws Error{kDamaged} when the record's size or planes are not those of its layout.
  ClipFrames(const store::Snapshot& snapshot, store::ClipId clip);
  std::uint32_t size() const;
  const media::PixelLayout& layout() const { return layout_; }
  /// Bit-identical to what was ingested, with its time. Decodes a slab of tiles for each frame: a pass over
  /// the clip is cheaper with read(first, count). Safe from many threads.
  media::Frame read(std::uint32_t frame) const;
  /// Frames [first, first + count), decoded together.
  std::vector<media::Frame> read(std::uint32_t first, std::uint32_t count) const;
  /// Their luminance alone, CV_8U, as media::to_luma has it: chroma that it does not need stays unread.
  std::vector<cv::Mat> read_luma(std::uint32_t first, std::uint32_t count) const;

 private:
  void read_planes(std::size_t planes, std::uint32_t first, std::vector<media::Frame>& frames) const;

  store::Snapshot snapshot_;
  store::ClipId clip_;
  media::PixelLayout layout_;
  std::vector<double> times_;
};

}  // namespace freshet::stored
