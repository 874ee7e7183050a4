// vision/loop_rule.h — where a clip can be joined to itself, so that it plays without an end.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

/// Frame `from` looks, and moves, like the earlier frame `to`: a clip played up to `from` goes on at `to`,
/// with a cross-fade of `fade` frames whose middle is at both. So the clip has fade / 2 frames before `to`
/// and after `from`.
struct LoopRule {
  std::uint32_t from = 0, to = 0;
  std::uint32_t fade = 0;  // frames, even
  /// Mean squared difference of the frames around `from` and `to`, as a fraction of what two unrelated frames
  /// of the clip differ by: 0 the same, 1 no more alike than any two.
  double distance = 1;
  std::uint32_t length() const { return from - to; }
};

/// The shortest clip that has a rule, frames: a loop of 12 and its cross-fade.
inline constexpr std::uint32_t kMinLoopFrames = 20;

/// Takes a clip's frames in order, and finds the best place to join its end to its beginning.
///
/// Distances are between frames reduced to at most 64 px per side; what stands still adds nothing to
/// them, so no mask is needed. They are filtered along the diagonal by binomial weights over five
/// neighbours: two frames are alike when what comes before and after them is, hence a wave that rises is
/// not joined to one that falls.
///
/// A loop is at least half as long as the clip, and longer ones are preferred: a shorter one must be
/// nearer by a quarter of the unrelated distance for each clip's length that it lacks. Of six clips
/// of water, 3 s each, without that floor three had loops of about half a second, whose repetition
/// shows, at a distance of 0.7.
///
/// Source   Schoedl, Szeliski, Salesin, Essa 2000, "Video Textures", Sec. 3.1 (distance, preserved dynamics)
///          and 4.1 (loops); their random play and Q-learning are for a player, not for a file.
/// Memory   at most 8 MB: of a long clip the first and the last 1024 frames. Cost about 0.3 ms per frame, and
///          2 ns per pixel of each pair at the end. Integers throughout: the same rule on every machine.
class LoopFinder {
 public:
  explicit LoopFinder(double fps);
  void add(const cv::Mat& luma);  // CV_8U, always the same size
  /// None for clips of less than kMinLoopFrames. All threads; the same for any number.
  std::optional<LoopRule> finish() const;

 private:
  double fps_;
  std::uint32_t frames_ = 0;
  std::vector<std::uint8_t> first_, last_;  // reduced frames, packed; of last_ a ring
  cv::Size size_;
  std::vector<std::uint64_t> sum_, squares_;  // by reduced pixel, over all frames
};

}  // namespace freshet::vision
