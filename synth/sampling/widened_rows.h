// synth/sampling/widened_rows.h — a coarse plane between its samples, row after row.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::sampling {

/// What cv::resize (INTER_LINEAR) makes of a plane, to the bit, without the plane that it writes: what takes the rows
/// may do its own work with them while they are in the cache.
class WidenedRows {
 public:
  /// coarse   CV_32F, finite; outlives this. size: of what is read, px.
  WidenedRows(const cv::Mat& coarse, cv::Size size);

  struct Row {
    const float *upper, *lower;
    float of_upper, of_lower;
    [[gnu::always_inline]] float at(int x) const { return upper[x] * of_upper + lower[x] * of_lower; }
  };
  /// Rows in ascending order; the last one's stands until the next call.
  Row at(int y);

 private:
  const float* widened(int row);

  cv::Mat coarse_;
  cv::Size size_;
  bool ready_ = false;  // coarse_ is as large as it is asked for
  double scale_y_ = 1;
  std::vector<std::int32_t> first_, next_;  // by column: samples before and after it
  std::vector<float> fraction_;             // of the second
  std::vector<float> lines_[2];             // of even and of odd rows
  int held_[2] = {-1, -1};
};

}  // namespace freshet::synth::sampling
