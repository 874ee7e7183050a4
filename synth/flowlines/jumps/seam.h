// synth/flowlines/jumps/seam.h — when each place goes over from one run to the next, so that it shows least.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::flowlines {

inline constexpr int kFading = 2;  // frames beyond a meeting's reach that are always left to fade in

/// What two runs differ by around the rung on which they meet: a place goes over with label d when it shows the later
/// run from d - reach frames after the front's arrival on.
struct Meeting {
  cv::Size size;
  int labels = 1;                 // 2 reach + 1
  std::vector<float> difference;  // by place, then by frame d - 1, d = 0 .. labels: labels + 1 values, >= 0
  const float* of(int place) const {
    return difference.data() + static_cast<std::size_t>(place) * static_cast<std::size_t>(labels + 1);
  }
};

/// frames    CV_8UC3, the clip reduced; corner   where in them the arrivals' upper left place lies.
/// arrival   CV_32F: frames from the front's entry to its arrival.
/// leaves    the frame of the clip in which the run that ends would have gone on at the line's beginning.
/// enters    that in which the next run begins there.
Meeting meeting_of(const std::vector<cv::Mat>& frames, cv::Point corner, const cv::Mat& arrival, int leaves,
                   int enters, int reach);

/// What a surface of labels shows of itself: at each place what the runs differ by in the frames before and after it
/// goes over; and between neighbours, by a quarter, what they differ by in all frames in which one has gone over and
/// the other not. (By the whole, as between pixels of a picture, a cut is flat in time: all goes over at once.)
/// labels    CV_8U, the meeting's size.
double cost_of(const Meeting& meeting, const cv::Mat& labels);

/// A surface of little cost: the graph cut of Kwatra et al. 2003 ("Graphcut Textures", Sec. 3) in space and time, for
/// which Bhat et al. 2004 hope in their last section. Solved by lines: each row, then each column, is given its best
/// labels exactly while its neighbours stay, in turn; on noise its cost is within 5 % of the smallest cut's
/// (seam_test).
///
/// Returns  CV_8U labels. Cost  places x labels x sweeps.
cv::Mat cut(const Meeting& meeting);

}  // namespace freshet::synth::flowlines
