// synth/animate/clips/clip_layer.h — all that one clip gives to an animation.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/blend/blend.h"
#include "synth/animate/clips/clip_luma.h"
#include "synth/animate/clips/patch_levels.h"
#include "synth/animate/placement/placement.h"
#include "synth/playing/timeline.h"
#include "synth/sampling/area_reduction.h"
#include "synth/sampling/patch_window.h"

namespace freshet::synth::animate {

/// What is shown of a moment between two frames of a clip. Measured on 75 frames at 25/s of clips at 30/s,
/// the picture's sharpness unmatched:
///                                              nearest   flow
///   change from frame to frame varies by          30 %   12 %   of its mean
///   the same at half speed                       127 %   11 %
///   Laplacian energy varies by                  11.4 %  9.4 %
/// The mean energy is 2.4 % less along the flow.
enum class Resampling {
  kNearest,  // the frame nearest in time
  kFlow,     // both frames, brought together along the flow kept in the store
};

/// What detail the patches give.
enum class ClipDetail {
  kDifference,  // to the average of what is shown
  kInnovation,  // what carrying the neighbouring frames along their flow does not explain (clip_luma.h)
};

/// Patches of one clip. Those that play at one speed share one timeline, so that neighbours stay in step.
class ClipLayer {
 public:
  /// placement for innovations halved (placement.h): they are found at half size (clip_luma.h).
  /// patches   of the placement that lie in this clip. options.speed, .phase and .whole are set here.
  /// tiles     of this snapshot, decoded earlier; may be null.
  /// Throws    as timeline().
  ClipLayer(const store::Snapshot& snapshot, store::ClipId clip, int flow_step, const Placement& placement,
            std::vector<std::size_t> patches, const playing::TimelineOptions& options, Resampling resampling,
            ClipDetail detail = ClipDetail::kDifference, stored::DecodedTiles* tiles = nullptr);

  /// The averages over all output frames, which every difference needs, or the patches' levels, in one pass through the
  /// clip.
  /// kept     output frames whose clip frames stay in memory afterwards.
  /// change   if not null, by output frame: grows by how much this clip's patches change from it to the next
  ///          (the last: to the first), mean |difference| times patches; an estimate from the clip's frames.
  /// Memory   the kept frames and two slabs of 16.
  void measure(std::span<const int> kept, std::vector<double>* change = nullptr);
  /// Differences of the output frames `outputs` to the average, cut out patch by patch, into the blender's
  /// frames 0, 1, ... Or their innovations. After measure(). Reads what is not in memory. All threads; the same for any
  /// number.
  void add(std::span<const int> outputs, Blender& blender);
  /// Mean squares by the blender's bands, finest first.
  struct DetailPower {
    std::vector<double> shown;  // of all detail
    std::vector<double> anew;   // of what carrying the neighbouring frames does not explain
  };
  /// By patch of the placement that lies in this clip, over these output frames. All threads; the same for any number.
  std::map<std::size_t, DetailPower> detail_power(std::span<const int> outputs, Blender& blender);
  /// Forgets the clip's frames, not the averages.
  void release();

  /// Patches of the placement that share a timeline, and what each output frame shows of them.
  struct Played {
    std::vector<std::size_t> patches;
    std::span<const playing::Moment> moments;
  };
  std::vector<Played> played() const;
  /// kInnovation: calls with each patch of the placement, output frame, and how much lighter than on average it is
  /// then: between two frames of the clip in proportion, as its mean hardly depends on where within it things have
  /// moved. After measure(). From many threads; of one patch from one.
  void each_level(const std::function<void(std::size_t patch, int output, float level)>& use) const;
  const ClipLuma& luma() const { return luma_; }

  /// Seconds spent in reading from the store.
  double read_s() const { return read_s_; }
  std::size_t average_bytes() const;
  /// The maximum that an output frame needs of the clip's frames.
  std::size_t bytes_per_output() const;

 private:
  struct Reduced {  // what is shown at one scale
    sampling::AreaReduction reduction;
    std::vector<cv::Rect> cells;       // of the reduced frame
    std::vector<std::size_t> members;  // into patches_
  };
  struct SpeedGroup {                  // patches at one speed
    std::vector<std::size_t> members;  // into patches_
    std::vector<playing::Moment> moments;
    std::vector<cv::Rect> cells;     // px of the source that its patches are made of
    std::vector<std::size_t> whole;  // members at whole size
    std::vector<Reduced> reduced;
    cv::Mat average;                    // kDifference: luma_.region(), CV_32F
    std::optional<PatchLevels> levels;  // kInnovation: of its members
  };
  struct Scratch {
    cv::Mat shown, innovation, reduced, window;
    std::vector<float> part, line;
    ClipLuma::Scratch luma;
  };
  struct Stretch {  // frames[first, end), which are in memory
    std::span<const std::uint32_t> frames;
    std::size_t first = 0, end = 0;
  };
  void lay_out(SpeedGroup& group) const;
  std::vector<int> shown_by(std::uint32_t frame, std::span<const int> outputs) const;
  void add_to_averages(const Stretch& stretch, std::span<const playing::FrameWeights> weights,
                       std::vector<float>* steps);
  void add_block(const cv::Rect& block, const Stretch& stretch,
                 std::span<const playing::FrameWeights> weights, std::span<double> steps);
  void add_change(std::span<const std::uint32_t> frames, std::span<const float> steps,
                  std::vector<double>& change) const;
  void load(std::span<const int> outputs, std::span<const std::uint32_t> more = {});
  void difference(const SpeedGroup& group, const playing::Moment& moment, Scratch& scratch) const;
  void innovation(const SpeedGroup& group, const playing::Moment& moment, Scratch& scratch) const;
  void frame(const SpeedGroup& group, std::uint32_t frame, Scratch& scratch) const;
  template <class Use>
  void each_window(const SpeedGroup& group, const cv::Mat& shown, Scratch& scratch, const Use& use);

  const Placement& placement_;
  std::vector<std::size_t> patches_;
  std::vector<sampling::PatchWindow> windows_;
  ClipLuma luma_;
  std::vector<SpeedGroup> groups_;
  ClipDetail detail_ = ClipDetail::kDifference;
  std::uint32_t frame_count_ = 0;  // of the clip
  double read_s_ = 0;
};

}  // namespace freshet::synth::animate
