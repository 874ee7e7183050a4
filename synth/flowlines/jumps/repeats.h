// synth/flowlines/jumps/repeats.h — in which order a clip's entries are repeated, so that it goes on for ever.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::flowlines {

/// Particles that enter in frames start, start + 1, ... of the output are those that entered in frames first,
/// first + 1, ... of the clip.
struct Run {
  std::int64_t start = 0;
  int first = 0, length = 0;
  std::int64_t end() const { return start + length; }
};

struct RepeatOptions {
  int min_run = 6;         // frames: a run is at least as long
  double freshness = 0.5;  // weight of what was not shown of late, by a mean jump's cost; 0: cost alone
  double chance = 0.3;     // weight of chance, in the same units: so that the order does not come again
  /// Frames that a jump wants to go over in, half of them to either side: between jumps that come sooner than in
  /// twice that it is seen the more.
  double fade = 0;
  /// All entries in turn, again and again, as Bhat et al. 2004 repeat the first K diagonals (Fig. 3 b): of what stands
  /// above nothing counts.
  bool in_turn = false;
  std::uint64_t seed = 1;
};

/// Chooses runs one after another, for ever, with the memory of one.
///
/// A jump leaves a rung of the ladder: behind the last particle of a run comes the first one of the next. The end of a
/// run and the next one's beginning are chosen together, for the least cost; never a run that begins where the one
/// before began, so that no run is the same twice in a row, and never one that could not last for min_run.
class Repeats {
 public:
  /// cost      (K + 1) x K, CV_32F, >= 0: of entry b (column) coming where entry a (row) would; row K: nothing more
  ///           would come. K at least 2 min_run.
  explicit Repeats(const cv::Mat& cost, const RepeatOptions& options = {});
  Run next();
  /// The cost of the jump that led to the run last given.
  double jump() const { return jump_; }

 private:
  double chance();

  cv::Mat cost_;
  RepeatOptions options_;
  double unit_ = 1;
  cv::Mat used_;  // as cost: how often of late a jump like this was made
  std::uint64_t random_;
  std::int64_t start_ = 0;
  int first_ = 0;  // of the run to come
  double jump_ = 0, jump_to_come_ = 0;
};

/// Runs that fill exactly `frames` frames, and the last of which leads into the first: of all such, those of least
/// cost, chance included.
/// frames    at least 2 min_run.
/// Returns   none when there is no such order; in turn, when K does not divide `frames`.
std::vector<Run> cyclic(const cv::Mat& cost, int frames, const RepeatOptions& options = {});

}  // namespace freshet::synth::flowlines
