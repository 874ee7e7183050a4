// synth/animate/forms/seats.h — where separate fires burn.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// One fire: the box of its light, and the columns that are its own.
struct Seat {
  double left = 0, top = 0, right = 0, bed = 0;  // px; between them lies nearly all of its light
  double first = 0, last = 0;                    // px: halfway to its neighbours, or the frame's sides
  double share = 0;                              // of all light, 0..1
  double width() const { return right - left; }
  double height() const { return bed - top; }
};

/// Fires that stand apart from each other by columns: a tip that has come off belongs to what burns below it. From left
/// to right, at most kMaxSeats; none where nothing shines. What is beside them, or less than a thirtieth of all, is no
/// seat.
/// level   CV_32F, 0..1, of some 200 px a side.
std::vector<Seat> seats_of(const cv::Mat& level);
inline constexpr int kMaxSeats = 5;
/// The same of a larger level, reduced to `samples` along its longer side; in its own pixels.
std::vector<Seat> seats_reduced(const cv::Mat& level, int samples);

/// All of them as one fire. seats  at least one. columns  of the frame.
Seat together(const std::vector<Seat>& seats, int columns);

}  // namespace freshet::synth::animate
