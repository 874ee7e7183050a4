#include "synth/transfer/files/extent.h"

#include "synth/transfer/pixel_grid.h"

namespace freshet::synth::transfer {

Extent extent_of(const cv::Mat& alpha, const TransferOptions& options) {
  Extent extent;
  for (const float at : blurred(grid_of(alpha), options.radius).values) {
    const auto blurred_alpha = static_cast<double>(at);
    if (blurred_alpha > options.lower) ++(blurred_alpha < options.upper ? extent.boundary : extent.interior);
  }
  return extent;
}

}  // namespace freshet::synth::transfer
