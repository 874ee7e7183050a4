// synth/animate/frames/clip_batches.h — what the clips show, merged into as many frames at once as the memory holds.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "synth/animate/blend/blend.h"
#include "synth/animate/clips/clip_layer.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/motion/motion_sequence.h"

namespace freshet::synth::animate {

/// What an animation holds beside its batch of frames, bytes per pixel of the picture.
inline constexpr std::size_t kPictureBytesPerPixel = 280;

/// One layer a clip, in the clips' order.
/// placement   the animation's, or halved.
std::vector<std::unique_ptr<ClipLayer>> clip_layers(const Animation& animation, const Placement& placement,
                                                    Resampling resampling, ClipDetail detail);
/// Adds how what is shown of a clip moves, output frame by output frame: of its flow in memory, where all of that is.
void add_motion(const Animation& animation, const ClipLayer& layer, MotionSums& sums);

/// The clips' layers, and a blender with a slot for each frame in hand.
class ClipBatches {
 public:
  /// animation, placement   outlive this.
  ClipBatches(Animation& animation, const Placement& placement, Resampling resampling, ClipDetail detail,
              const BlendOptions& options);

  /// Frames in hand at once.
  int batch() const { return batch_; }
  /// Whether that is all of them: each clip is then read once.
  bool in_one() const;
  /// Output frames, evenly spread, that stand for all where all cannot be in hand.
  std::span<const int> samples() const { return samples_; }

  /// The first pass through every clip: `measure` is given the layer, and the output frames whose clip frames it is to
  /// keep: the first `needed` when all are in hand, else the samples. These are then merged: the samples only for
  /// who wants them, a model that is fitted to them.
  void begin(int needed, bool with_samples,
             const std::function<void(ClipLayer&, std::span<const int> kept)>& measure);
  /// Merges the differences of these frames, unless begin() has merged all.
  void read(std::span<const int> outputs);

  Blender& blender() { return blender_; }
  /// Where the blender has a frame, which was merged last.
  int slot(int output) const { return slot_[static_cast<std::size_t>(output)]; }

 private:
  void merge(ClipLayer& layer, std::span<const int> outputs);
  void take_lap();

  Animation& animation_;
  std::vector<std::unique_ptr<ClipLayer>> layers_;
  int batch_ = 0;
  std::vector<int> samples_, slot_;  // slot_: by output frame
  Blender blender_;
  double read_s_ = 0;  // of the layers, in the report already
};

}  // namespace freshet::synth::animate
