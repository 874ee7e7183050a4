// synth/flowlines/ladder.h — what each jump between repeats would cost.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/arrival.h"
#include "synth/flowlines/jumps/repeats.h"

namespace freshet::synth::flowlines {

/// Frames beyond the entries that comparing and going over need: nearer to its ends a clip would seem to stand still.
inline constexpr int kLeastMargin = 4;

/// The repeats of one stream.
struct Ladder {
  int first = 0;         // frame of the clip that entry 0 is
  cv::Mat cost;          // (K + 1) x K, for Repeats: 1 is what unrelated moments of the stream differ by
  double changes = 1;    // how many frames' changes unrelated moments differ by
  double fade = 0;       // RepeatOptions
  double per_frame = 0;  // cost of the jumps that an order makes, by frame
  double jump = 0;       // of one of them
  int min_run = 6;
  int entries() const { return cost.cols; }
};

/// A clip's frames for comparison, made once.
class Ladders {
 public:
  /// frames    CV_8UC3, the working picture's size.
  explicit Ladders(const std::vector<cv::Mat>& frames);

  /// Sheared by the arrivals, a clip's frame e shows each particle that entered in frame e wherever it goes; what is
  /// left is Video Textures (Schoedl et al. 2000) on sheared frames: they are compared in windows of time, so that
  /// what comes before and after a jump is alike too; and block by block, each in the best of some frames.
  ///
  /// where     CV_8U, not 0 where the stream is.
  /// margin    frames before the first entry and after the last, which feathering shows; kLeastMargin or more.
  /// entries   K, at least 4: with the margins and the stream's duration at most the clip's frames.
  /// Cost      K^2 comparisons of frames reduced by 4, and some 80 K^2 bytes while they are made, however large the
  ///           picture is. The same for any number of threads.
  Ladder of(const Stream& stream, const cv::Mat& where, int margin, int entries,
            const RepeatOptions& options) const;
  /// The frames reduced, CV_8UC3.
  const std::vector<cv::Mat>& frames() const { return small_; }

 private:
  std::vector<cv::Mat> small_;
};

}  // namespace freshet::synth::flowlines
