#include "stored/patch_video.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::stored {
namespace {

cv::Rect around(const cv::Matx23d& source_from_variant, cv::Rect square, cv::Size source) {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (const cv::Point corner :
       {square.tl(), cv::Point(square.x + square.width - 1, square.y),
        cv::Point(square.x, square.y + square.height - 1), square.br() - cv::Point(1, 1)}) {
    const cv::Vec2d at = source_from_variant * cv::Vec3d(corner.x, corner.y, 1);
    left = std::min(left, at[0]);
    right = std::max(right, at[0]);
    top = std::min(top, at[1]);
    bottom = std::max(bottom, at[1]);
  }
  // Two px more: a reduced pixel covers so much, and interpolation wants the next one.
  const cv::Point first(static_cast<int>(std::floor(left)) - 2, static_cast<int>(std::floor(top)) - 2);
  const cv::Point last(static_cast<int>(std::ceil(right)) + 3, static_cast<int>(std::ceil(bottom)) + 3);
  return cv::Rect(first, last) & cv::Rect({}, source);
}

}  // namespace

void read_patch(const store::Snapshot& snapshot, const media::PixelLayout& layout, const PatchPlace& place,
                Shown shown, cv::Mat& out) {
  const cv::Size source(layout.width, layout.height), side(place.side, place.side);
  const cv::Rect square(place.corner, side);
  const vision::VariantFrame frame = vision::variant_frame(source, place.variant);
  const bool whole = place.variant.scale == 1 && place.variant.rotation_deg == 0;
  cv::Rect region = around(frame.source_from_variant, square, source);
  if (whole)
    region = {{place.variant.flip ? source.width - square.x - square.width : square.x, square.y}, side};
  const std::vector<cv::Mat> shown_frames =
      read_region(snapshot, place.clip, layout, region, place.first, place.count, shown);

  const double scale = std::min(1.0, static_cast<double>(place.variant.scale));
  const cv::Size reduced_size(std::max(1, cvRound(region.width * scale)),
                              std::max(1, cvRound(region.height * scale)));
  // Pixel centres: a place of the patch, in the variant, in the source, in the region, in the reduced region.
  const double rx = static_cast<double>(reduced_size.width) / region.width;
  const double ry = static_cast<double>(reduced_size.height) / region.height;
  const cv::Matx23d& m = frame.source_from_variant;
  const cv::Vec2d corner = m * cv::Vec3d(square.x, square.y, 1);
  const cv::Matx23d reduced_from_patch(rx * m(0, 0), rx * m(0, 1), rx * (corner[0] - region.x + 0.5) - 0.5,
                                       ry * m(1, 0), ry * m(1, 1), ry * (corner[1] - region.y + 0.5) - 0.5);

  const int shape[] = {static_cast<int>(place.count), place.side, place.side};
  out.create(3, shape, shown == Shown::kBgr ? CV_8UC3 : CV_8U);
  cv::Mat reduced;
  for (std::uint32_t i = 0; i < place.count; ++i) {
    cv::Mat patch(place.side, place.side, out.type(), out.ptr(static_cast<int>(i)));
    if (whole && place.variant.flip) {
      cv::flip(shown_frames[i], patch, 1);
    } else if (whole) {
      shown_frames[i].copyTo(patch);
    } else {
      reduced = shown_frames[i];
      if (reduced_size != region.size())
        cv::resize(shown_frames[i], reduced, reduced_size, 0, 0, cv::INTER_AREA);
      cv::warpAffine(reduced, patch, reduced_from_patch, side, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                     cv::BORDER_REPLICATE);
    }
  }
}

}  // namespace freshet::stored
