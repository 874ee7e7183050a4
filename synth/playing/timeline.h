// synth/playing/timeline.h — which moments of its clip an animation shows, frame by frame.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vision/loop_rule.h"

namespace freshet::synth::playing {

/// What an output frame shows of a clip: one moment, or two in a cross-fade.
struct Moment {
  std::array<double, 2> at{0, 0};  // clip frames; 2.25 lies a quarter of the way from frame 2 to frame 3
  std::array<float, 2> weight{1, 0};
  int count() const { return weight[1] == 0 ? 1 : 2; }
  /// The clip frame that counts for more.
  double louder() const { return at[weight[1] > weight[0] ? 1 : 0]; }
};

/// Calls with each clip frame that a moment needs, and its weight: those around it in time, by how near they are.
template <class Use>
void each_frame(const Moment& moment, const Use& use) {
  for (int i = 0; i < moment.count(); ++i) {
    const auto frame = static_cast<std::uint32_t>(moment.at[i]);
    const double fraction = moment.at[i] - frame;
    use(frame, moment.weight[i] * (1 - fraction));
    if (fraction > 0) use(frame + 1, moment.weight[i] * fraction);
  }
}

/// How much each clip frame counts in all moments together: by clip frame, of a sum of 1.
using FrameWeights = std::map<std::uint32_t, double>;
FrameWeights frame_weights(std::span<const Moment> moments);

struct TimelineOptions {
  int frames = 96;     // of the animation
  double fps = 25;     // of the animation
  double speed = 1;    // clip seconds per second of the animation
  bool loop = false;   // periodic: the last frame is followed by the first
  double phase = 0;    // 0..1, loop: where in the period the clip begins; so that not all clips fade at once
  bool whole = false;  // only whole frames, the nearest in time
};

/// Plays a clip for the whole animation: forward from its first frame, and where it is too short, by its loop
/// rule as often as needed. With `loop` it runs through a whole number of loops of equal length, as near to
/// the rule's as fits.
///
/// Cross-fades keep the variance: a plain cross-fade of unrelated frames would lose half of their power. The
/// weights of the two moments are cos and sin of a quarter turn, divided by the root of
/// 1 + 2 cos sin (1 - rule.distance): frames at distance d have the correlation 1 - d. They are weights of
/// differences to the average.
///
/// times      of the clip's frames, s, ascending; at least one.
/// interval   of the last frame, s.
/// rule       of the clip; where it has none, a clip that is long enough still plays once.
/// where      names the clip in messages.
/// Throws     Error{kInput} when the clip is shorter than the animation, or a loop is asked, and it has no
///            rule.
std::vector<Moment> timeline(std::span<const double> times, double interval,
                             const std::optional<vision::LoopRule>& rule, const std::string& where,
                             const TimelineOptions& options);

}  // namespace freshet::synth::playing
