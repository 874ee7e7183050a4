#include "synth/animate/placement/piece_values.h"

#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {

PieceValues::PieceValues(const Placement& placement) : side_(placement.side), stride_(placement.stride) {
  const cv::Rect canvas = canvas_of(placement);
  canvas_ = canvas.size();
  present_ =
      cv::Mat::zeros((canvas.height - side_) / stride_ + 1, (canvas.width - side_) / stride_ + 1, CV_32F);
  for (const PlacedPatch& placed : placement.patches) {
    at_.push_back((placed.piece - canvas.tl()) / stride_);
    present_.at<float>(at_.back()) = 1;
  }
}

cv::Mat PieceValues::over_canvas(const cv::Mat& values, double reach) const {
  cv::Mat sum, mass, shared, out;
  cv::GaussianBlur(values, sum, {}, reach, reach, cv::BORDER_CONSTANT);
  cv::GaussianBlur(present_, mass, {}, reach, reach, cv::BORDER_CONSTANT);
  cv::divide(sum, cv::max(mass, 1e-6), shared);
  // Piece (i, j)'s middle lies at i * stride + (side - 1) / 2.
  const double stride = stride_, offset = (side_ - 1) / 2.0;
  const cv::Matx23d lattice_from_canvas(1 / stride, 0, -offset / stride, 0, 1 / stride, -offset / stride);
  cv::warpAffine(shared, out, lattice_from_canvas, canvas_, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return out;
}

}  // namespace freshet::synth::animate
