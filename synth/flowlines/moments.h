// synth/flowlines/moments.h — which frames of the clip each place of an output frame shows.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/arrival.h"
#include "synth/flowlines/jumps/fading.h"
#include "synth/flowlines/jumps/repeats.h"
#include "synth/flowlines/ladder.h"

namespace freshet::synth::flowlines {

/// What a place shows: frames of the clip and their weights, which sum to 1. One between rungs; two where a rung goes
/// by; as many of a neighbouring stream where the two meet.
struct Moment {
  std::array<std::uint16_t, 4> frame{};
  std::array<float, 4> weight{};
  int count = 0;

  void add(std::uint16_t of, float share) {
    if (share <= 0) return;
    for (int i = 0; i < count; ++i)
      if (frame[static_cast<std::size_t>(i)] == of) {
        weight[static_cast<std::size_t>(i)] += share;
        return;
      }
    frame[static_cast<std::size_t>(count)] = of;
    weight[static_cast<std::size_t>(count++)] = share;
  }
  bool same_frames(const Moment& other) const { return count == other.count && frame == other.frame; }
};

/// The runs of one stream, in a window that moves on: no memory of what is over.
class Order {
 public:
  /// Endless: begins `before` frames before output frame 0.
  Order(const Ladder& ladder, const RepeatOptions& options, int before);
  /// A loop: the runs of one period of `frames`, the first of which begins `before` frames before output frame 0.
  Order(const Ladder& ladder, std::vector<Run> period, int frames, int before);
  /// Runs that cover entries [from, until), in order; `from` never falls. Firsts are frames of the clip.
  const std::deque<Run>& covering(std::int64_t from, std::int64_t until);

 private:
  void extend();
  int first_ = 0;
  std::optional<Repeats> repeats_;
  std::int64_t shift_ = 0;  // of the runs' starts
  std::vector<Run> period_;
  std::int64_t frames_ = 0, periods_ = 0;
  std::size_t next_ = 0;
  std::deque<Run> window_;
};

/// What overlaps are cut by.
struct CutOptions {
  /// CV_8UC3, the clip reduced; none: overlaps are feathered alone.
  const std::vector<cv::Mat>* frames = nullptr;
  /// CV_8UC3, the clip of the arrivals' size, for fades; given with the frames.
  const std::vector<cv::Mat>* whole = nullptr;
  /// Frames that a place may go over before or after its particles do, fading included: kLeastMargin or more.
  int margin = 6;
};

/// Between rungs a place shows the clip as it was filmed, later or earlier by a whole number of frames. A rung goes
/// through a stream as its particles do; over `fade` frames to either side of it the particles of both runs overlap.
///
/// With a cut, each place goes over where its surroundings show it least, and fades only about that.
///
/// The share of the later run is that of its particles' textures: tents half a patch long to either side, dense along
/// the line. It is the integral of a tent: Bhat et al. 2004, Sec. 3, "Particle Rendering", feathering.
class Moments {
 public:
  /// fade     CV_32F, frames, > 0, at most the ladders' margin; where overlaps are cut, the cut says it.
  /// orders   by stream.
  Moments(const Arrivals& arrivals, cv::Mat fade, std::vector<Order> orders, int clip_frames,
          const CutOptions& cut = {});
  /// Frames in order. out: as large as the working picture, overwritten; rows of Moment. All threads.
  void at(std::int64_t frame, std::vector<Moment>& out);
  cv::Size size() const { return fade_.size(); }

 private:
  struct Rung {
    std::int64_t from = 0, to = 0;  // frames of the clip less the output's
    std::int64_t start = 0;         // frame in which the later run enters
    cv::Mat arrival;                // CV_32F, of that run: frames from its start until a place goes over
    cv::Mat fade;                   // CV_32F, frames to either side of that
  };
  void bring_rungs(std::size_t stream, std::int64_t frame);
  Rung rung_of(std::size_t stream, const Run& before, const Run& run) const;
  void cut_rung(std::size_t stream, const Jump& jump, Rung& rung) const;
  void add(std::size_t stream, cv::Point at, std::int64_t frame, float share, Moment& moment) const;

  const Arrivals* arrivals_;
  cv::Mat fade_;
  std::vector<Order> orders_;
  int clip_frames_;
  CutOptions cut_;
  std::optional<Fading> fading_;
  std::vector<cv::Rect> cells_;  // by stream: where it shows, in px of the cut's frames
  std::int64_t reach_ = 0;       // frames that a rung needs at most, fade included
  std::vector<std::deque<Rung>> rungs_;
};

}  // namespace freshet::synth::flowlines
