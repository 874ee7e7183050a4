// synth/flowlines/arrival.h — when a front that enters with the fluid reaches each place of the picture.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "synth/flowlines/lines/flow_line.h"
#include "synth/flowlines/rides.h"

namespace freshet::synth::flowlines {

/// Lines that lie beside each other and run the same way, in a strand about as wide as asked: a front goes through them
/// together. Each stream has its own order of repeats, so that the picture as a whole does not come again.
struct Stream {
  /// CV_32F, the picture's size: frames from the front's entry to its arrival, 0 .. duration. Beyond the lines it goes
  /// on smoothly.
  cv::Mat arrival;
  /// The same by the frame in which the front enters, reduced by kEntryStep; empty when the dynamics are stationary.
  std::vector<cv::Mat> arrival_of_entry{};
  static constexpr int kEntryStep = 4;
  float duration = 0;  // frames
};

struct Arrivals {
  std::vector<Stream> streams;
  cv::Mat stream;             // CV_8U, the picture's size: to which stream a place belongs
  cv::Mat neighbour, share;   // CV_8U and CV_32F: the next one, and how far it shows here, 0..0.5
  cv::Mat speed;              // CV_32F, px a frame along the nearest lines
  std::vector<int> of_line;   // by line: its stream
  std::vector<float> offset;  // by line: frames until the front reaches the line's beginning, >= 0
};

struct StrandOptions {
  double spacing_px = 12;  // between neighbouring lines
  double width_px = 72;    // of a stream, across; 0: all that lies side by side is one
  double blend_px = 12;    // over which neighbouring streams go over into each other
};

inline constexpr int kMaxStreams = 24;  // the smallest beyond these join the largest

/// Lines begin anywhere, a streamline where room was left for it; a front that entered all of them at once would jump
/// from line to line. So each line is given an offset: over all places where two lines lie side by side, arrivals
/// differ least (least squares).
///
/// A particle can be followed for as long as the clip lasts, and slow ones do not get far in it. So what is slower than
/// a floor is passed over at once: there one run fades into the next in its place, and only the faster fluid rides.
/// (A front that sped up over the slow fluid swept through the picture faster than anything in it, and was seen to.)
///
/// floor       px a frame; 0: none.
/// by_entry    whether arrival_of_entry is filled in, where the rides have entries.
/// Throws      nothing; lines must not be empty.
/// Source      ours. Bhat et al. 2004, Fig. 3, have the ladder of one line, and leave its neighbours to feathering.
Arrivals arrivals(const std::vector<FlowLine>& lines, const Rides& rides, cv::Size picture,
                  const StrandOptions& strands, float floor, bool by_entry);

/// The least floor with which no stream takes longer than `way` frames; 0 when none does as it is.
float floor_for(const std::vector<FlowLine>& lines, const Rides& rides, const StrandOptions& strands,
                float way);

/// Of all places of the lines, the share that is slower than the floor.
double share_below(const Rides& rides, float floor);

}  // namespace freshet::synth::flowlines
