#include "synth/animate/frames/enlarge.h"

#include <opencv2/imgproc.hpp>

#include "query/search/picture_scale.h"

namespace freshet::synth::animate {

void add_enlarged(const cv::Mat& field, const cv::Rect& canvas, double scale, cv::Mat& luma) {
  const cv::Size reduced = query::reduced_size(luma.size(), scale);
  const cv::Rect seen = canvas & cv::Rect({}, reduced);
  if (seen.empty()) return;
  const cv::Mat visible = field(seen - canvas.tl());
  if (reduced == luma.size()) {
    cv::Mat inside = luma(seen);
    cv::add(inside, visible, inside);
    return;
  }
  cv::Mat whole = cv::Mat::zeros(reduced, CV_32F), enlarged;
  visible.copyTo(whole(seen));
  cv::resize(whole, enlarged, luma.size(), 0, 0, cv::INTER_CUBIC);
  cv::add(luma, enlarged, luma);
}

}  // namespace freshet::synth::animate
