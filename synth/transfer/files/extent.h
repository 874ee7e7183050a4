// synth/transfer/files/extent.h — how much boundary and how much interior a fluid has.
#pragma once

#include <algorithm>

#include <opencv2/core.hpp>

#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// Pixels of a frame by segment, or their mean over frames.
struct Extent {
  double boundary = 0, interior = 0;

  double all() const { return boundary + interior; }
  double interior_share() const { return all() > 0 ? interior / all() : 0; }
};

/// alpha  CV_32F, 0..1. The radius and the thresholds are the options'.
Extent extent_of(const cv::Mat& alpha, const TransferOptions& options);

/// The mean of at most `most` frames, spread over all. alpha(i), i from 0, is called in order.
template <class Alpha>
Extent mean_extent(int frames, int most, const TransferOptions& options, const Alpha& alpha) {
  Extent sum;
  const int looked_at = std::min(frames, most);
  for (int i = 0; i < looked_at; ++i) {
    const Extent one = extent_of(alpha(i * frames / looked_at), options);
    sum.boundary += one.boundary / looked_at;
    sum.interior += one.interior / looked_at;
  }
  return sum;
}

}  // namespace freshet::synth::transfer
