#include "synth/animate/frames/pieces_canvas.h"

#include <opencv2/imgproc.hpp>

#include "synth/animate/placement/pieces_picture.h"
#include "synth/sampling/coarse_samples.h"

namespace freshet::synth::animate {

PiecesCanvas::PiecesCanvas(const Placement& placement, cv::Size picture)
    : rect_(canvas_of(placement)),
      scale_(placement.piece_scale),
      reduced_(pieces_picture(placement, picture)) {}

cv::Mat PiecesCanvas::cut(const cv::Mat& plane) const {
  const cv::Rect all = rect_ | cv::Rect({}, reduced_);
  cv::Mat reduced = plane, wide;
  if (reduced_ != plane.size()) cv::resize(plane, reduced, reduced_, 0, 0, cv::INTER_AREA);
  if (all.size() == reduced_) return reduced(rect_);
  cv::copyMakeBorder(reduced, wide, -all.y, all.br().y - reduced_.height, -all.x, all.br().x - reduced_.width,
                     cv::BORDER_REFLECT_101);
  return wide(rect_ - all.tl());
}

cv::Mat PiecesCanvas::cut_samples(const cv::Mat& samples, int step) const {
  cv::Mat out;
  cv::warpAffine(samples, out, sampling::samples_from_pixels(step, scale_, rect_.tl()), rect_.size(),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

cv::Mat PiecesCanvas::sampled(const cv::Mat& plane, int step, cv::Size size) const {
  cv::Mat out, pixels_from_samples;
  cv::invertAffineTransform(sampling::samples_from_pixels(step, scale_, rect_.tl()), pixels_from_samples);
  cv::warpAffine(plane, out, pixels_from_samples, size, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return out;
}

}  // namespace freshet::synth::animate
