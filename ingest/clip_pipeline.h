// clip_pipeline.h — one pass over a clip's frames: stored, and measured in every way that needs all of them.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include <opencv2/core.hpp>

#include "ingest/ingest.h"
#include "ingest/screening.h"
#include "media/frame/frame.h"
#include "store/store.h"
#include "stored/clip_columns.h"
#include "vision/detail_lifetime.h"
#include "vision/loop_rule.h"
#include "vision/settings.h"
#include "vision/temporal_spectrum.h"

namespace freshet::ingest {

/// Frames in hand at a time: as many as a tile is deep.
inline constexpr int kSlab = 16;
/// Flow over a window of 8 pairs is the minimum that vision::MotionAccumulator takes.
inline constexpr std::uint32_t kMinAnalysedFrames = 9;

/// What one pass leaves behind.
struct ClipMeasures {
  std::uint32_t frames = 0;
  Screening screening;
  cv::Mat moving;               // CV_8U, see moving_mask; nothing that was crossed
  cv::Mat crossed;              // CV_8U, see CrossingFinder; empty: nothing crossed
  stored::ClipColumns columns;  // without patches
  std::array<float, vision::kLifeBands> half_life_s{},
      standing{};                        // vision::DetailLifetimes::clip, clip_standing
  std::optional<vision::LoopRule> loop;  // none: too short to have one
};

/// The next frame of a clip, nothing at its end; called from one thread at a time.
using FrameSource = std::function<std::optional<media::Frame>()>;

/// Reads all frames, appends streams kFrames and kFlow to the writer, and measures. While a slab is worked
/// on by all threads, one of them decodes the next.
///
/// writer   called from the calling thread only.
/// on_slab  called after each slab with the number of frames done.
/// Throws   Error{kInput}: no frames, fewer than kMinAnalysedFrames, what the source throws;
///          Error{kCancelled}.
/// Memory   two slabs of frames with their luma, one slab of quantised flow and the accumulators' sums by
///          pixel, whatever the clip's length; 40 bytes per frame of times and changes; what the store's transaction
///          has yet to write, at most some 64 MB. Peak of a process: 177 MB at 640 x 360, 430 MB at 1280 x 720.
ClipMeasures stream_clip(const FrameSource& next, double fps, const std::string& where,
                         const vision::Settings& settings, store::ClipWriter& writer,
                         const std::function<void(std::uint32_t)>& on_slab, const std::stop_token& stop,
                         IngestSeconds& seconds);

}  // namespace freshet::ingest
