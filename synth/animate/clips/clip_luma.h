// synth/animate/clips/clip_luma.h — the luminance of one clip at any moment, where patches need it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame/frame.h"
#include "store/store.h"
#include "stored/clip_frames.h"
#include "stored/decoded_tiles.h"

namespace freshet::synth::animate {

/// Frames of one clip in memory, where the needed rectangles touch 64 x 64 blocks of it: raw samples, or at half size,
/// and the flow between them where it is asked for. All px and rectangles are of the frame in that size.
///
/// A moment between two frames is made of both, each brought there along the flow kept in the store, and
/// mixed by their distance in time. Where the two disagree the nearer one counts more: a mixture of what does
/// not match halves its contrast. The flow of a pixel is taken where the pixel is, not where it came from:
/// the flow of fluids is smooth, and the motion between frames is a few pixels.
class ClipLuma {
 public:
  enum class Size {
    kWhole,  // raw samples, for at()
    kHalf,   // luma of squares of two by two, CV_32F, for innovation(): the flow tells no finer
  };
  /// needed     rectangles of the frame; beyond them luminance may be anything.
  /// flow_step  of the store's settings.
  /// tiles      of this snapshot, decoded earlier; may be null.
  ClipLuma(const store::Snapshot& snapshot, store::ClipId clip, Size size, std::span<const cv::Rect> needed,
           int flow_step, stored::DecodedTiles* tiles = nullptr);
  /// Of a whole frame, odd sides with half a sample more.
  static cv::Size size_of(cv::Size whole, Size size);

  /// Holds exactly these frames (ascending), and the flows from frames `flows` to their next (ascending).
  /// What is there already is kept, all else is read, each tile once. All threads. Throws Error{kDamaged}
  /// when the clip has no flow of the shape it should have.
  void load(std::span<const std::uint32_t> frames, std::span<const std::uint32_t> flows = {});

  /// The maximum that at() makes at once: small, so that all it needs stays in the nearest cache.
  static constexpr int kCellWidth = 32, kCellHeight = 16;
  class Scratch {
   public:
    Scratch();

   private:
    friend class ClipLuma;
    std::vector<std::int32_t> x, y;
    std::vector<float> u, v, from, to, mixed, window;
  };
  /// Luma at a moment of frames that are loaded, whole, 0..1, in a rectangle of source() within region(), no larger
  /// than a cell: out holds its rows one after another. Safe from many threads.
  void at(double moment, const cv::Rect& cell, float* out, Scratch& scratch) const;
  /// What of a frame carrying its neighbours in time does not explain: the frame less the mean of the one before
  /// and the one after, each brought to it along the flow kept in the store. The neighbours that there are, and
  /// the flows from `frame` and from the one before it, are loaded. At half size. Else as at().
  void innovation(std::uint32_t frame, const cv::Rect& cell, float* out, Scratch& scratch) const;
  /// Luma of a loaded frame at row y, columns x .. x + n - 1 of source(), within region().
  void row(std::uint32_t frame, int x, int y, int n, float* out) const;
  /// Mean luma of a loaded frame at places of source(), within blocks(); at least one.
  float mean(std::uint32_t frame, std::span<const cv::Point> places) const;

  /// Planes u and v of a loaded flow, CV_16S: its samples under the blocks, and where these lie in the clip's flow.
  std::array<cv::Mat, 2> flow(std::uint32_t frame) const { return {flows_.at(frame).u, flows_.at(frame).v}; }
  bool holds_flow(std::uint32_t frame) const { return flows_.contains(frame); }
  const cv::Rect& flow_region() const { return flow_region_; }

  /// The blocks that are read, and the rectangle around all of them.
  std::span<const cv::Rect> blocks() const { return blocks_; }
  const cv::Rect& region() const { return region_; }
  cv::Size source() const { return source_; }
  /// Bytes of a loaded frame, and of the flow to its next.
  std::size_t frame_bytes() const;
  std::size_t flow_bytes() const;

 private:
  void row(const cv::Mat& samples, int x, int y, int n, float* out) const;  // from the region's corner
  void read_frames(std::span<const std::uint32_t> missing);
  cv::Size plane_size() const;
  void put_halved(const std::byte* rows, const cv::Rect& block, int bytes, cv::Mat& into) const;
  void read_flows(std::span<const std::uint32_t> missing);
  void between(std::uint32_t frame, float fraction, const cv::Rect& cell, float* out, Scratch& scratch) const;
  void flow_of_cell(std::uint32_t frame, const cv::Rect& cell, Scratch& scratch) const;
  void carried(std::uint32_t frame, float fraction, const cv::Rect& cell, float* out, Scratch& scratch) const;
  void check_flow() const;

  store::Snapshot snapshot_;
  store::ClipId clip_;
  stored::DecodedTiles* tiles_ = nullptr;
  stored::ClipFrames clip_frames_;
  media::PixelLayout layout_;
  bool raw_ = true;  // luma samples as stored, else 8-bit luma that had to be computed
  int by_ = 1;       // px of the source that a frame's sides are reduced by
  int flow_step_ = 2;
  cv::Size source_, flow_size_;
  cv::Rect region_, flow_region_;
  std::vector<cv::Rect> blocks_, stored_;    // the same blocks, of the reduced and the stored frame
  float black_ = 0, per_span_ = 1.0f / 255;  // of samples of a byte
  std::vector<float> luma_of_;               // by sample, of two bytes
  // Where a column and a row of the region lie between samples of the flow's region.
  struct Between {
    std::vector<std::int32_t> first;
    std::vector<float> fraction;  // of the one after it
  };
  Between flow_across_, flow_down_;
  std::map<std::uint32_t, cv::Mat> frames_;  // raw, or at half size with a border
  struct Flow {
    cv::Mat u, v;  // CV_16S, 1/64 px
  };
  std::map<std::uint32_t, Flow> flows_;
};

}  // namespace freshet::synth::animate
