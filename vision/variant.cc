#include "vision/variant.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

// cv::warpAffine keeps coordinates in 16 bits.
constexpr int kMaxSide = 32767;

struct Turn {
  double cosine, sine;
};

Turn turn_of(float rotation_deg) {
  const double radians = rotation_deg * std::numbers::pi / 180;
  Turn turn{std::cos(radians), std::sin(radians)};
  // A quarter turn is exact: without this its frame would grow by a column.
  if (std::abs(turn.cosine) < 1e-12) turn.cosine = 0;
  if (std::abs(turn.sine) < 1e-12) turn.sine = 0;
  return turn;
}

int rounded_up(double length) { return std::max(1, static_cast<int>(std::ceil(length - 1e-6))); }

// How an unflipped variant is made: the source reduced by area, then one bilinear warp of the reduced
// picture.
struct VariantWarp {
  cv::Size reduced;                  // px
  cv::Matx23d reduced_from_variant;  // pixel centres
  bool warps = true;                 // false: the reduced picture is the variant
};

VariantWarp resampling_of(cv::Size source, const Variant& variant, const VariantFrame& unflipped) {
  VariantWarp resampling;
  resampling.reduced = source;
  if (variant.scale < 1) {
    resampling.reduced = {std::max(1, cvRound(source.width * static_cast<double>(variant.scale))),
                          std::max(1, cvRound(source.height * static_cast<double>(variant.scale)))};
  }
  // cv::resize maps the whole source onto the whole reduced picture, so rounding its size changes the ratio
  // a little: the warp takes that up, and the variant's scale stays exact.
  const double rx = static_cast<double>(resampling.reduced.width) / source.width;
  const double ry = static_cast<double>(resampling.reduced.height) / source.height;
  const cv::Matx23d& m = unflipped.source_from_variant;
  resampling.reduced_from_variant = {rx * m(0, 0), rx * m(0, 1), rx * (m(0, 2) + 0.5) - 0.5,
                                     ry * m(1, 0), ry * m(1, 1), ry * (m(1, 2) + 0.5) - 0.5};
  const cv::Matx23d identity(1, 0, 0, 0, 1, 0);
  const double distance = cv::norm(resampling.reduced_from_variant - identity, cv::NORM_INF);
  resampling.warps = resampling.reduced != unflipped.size || distance > 1e-6;
  return resampling;
}

Variant without_flip(Variant variant) {
  variant.flip = false;
  return variant;
}

}  // namespace

std::vector<Variant> make_variants(const std::vector<float>& scales, const std::vector<float>& rotations_deg,
                                   bool flips) {
  std::vector<Variant> variants;
  for (const float scale : scales) {
    for (const float rotation : rotations_deg) {
      variants.push_back({scale, rotation, false});
      if (flips) variants.push_back({scale, rotation, true});
    }
  }
  return variants;
}

VariantFrame variant_frame(cv::Size source, const Variant& variant) {
  if (source.width < 1 || source.height < 1 || source.width > kMaxSide || source.height > kMaxSide) {
    throw Error(ErrorKind::kInput, "variant",
                "a frame of " + std::to_string(source.width) + " x " + std::to_string(source.height) +
                    " px; 1 to 32767 px per side expected");
  }
  if (!(variant.scale > 0 && variant.scale <= 16) || !(std::abs(variant.rotation_deg) <= 360)) {
    throw Error(ErrorKind::kUsage, "variant",
                "scale " + std::to_string(variant.scale) + ", rotation " +
                    std::to_string(variant.rotation_deg) +
                    "; scale in 0..16 and rotation in -360..360 degrees expected");
  }
  const auto [c, s] = turn_of(variant.rotation_deg);
  const double scale = variant.scale;

  VariantFrame frame;
  frame.size = {rounded_up(scale * (source.width * std::abs(c) + source.height * std::abs(s))),
                rounded_up(scale * (source.width * std::abs(s) + source.height * std::abs(c)))};
  if (frame.size.width > kMaxSide || frame.size.height > kMaxSide) {
    throw Error(ErrorKind::kInput, "variant", "the scaled and rotated frame is larger than 32767 px");
  }

  // With y down, a counter-clockwise turn as seen takes "right" to "up": (1, 0) to (c, -s).
  const cv::Matx22d turned(scale * c, scale * s, -scale * s, scale * c);
  const cv::Matx22d flipped(variant.flip ? -1 : 1, 0, 0, 1);
  frame.variant_from_source_velocity = flipped * turned;

  // Centre lies on centre, so a flipped frame is the exact mirror image of its twin.
  const cv::Matx22d back = frame.variant_from_source_velocity.inv();
  const cv::Vec2d source_centre((source.width - 1) / 2.0, (source.height - 1) / 2.0);
  const cv::Vec2d variant_centre((frame.size.width - 1) / 2.0, (frame.size.height - 1) / 2.0);
  const cv::Vec2d shift = source_centre - back * variant_centre;
  frame.source_from_variant = {back(0, 0), back(0, 1), shift[0], back(1, 0), back(1, 1), shift[1]};
  return frame;
}

cv::Mat warp_to_variant(const cv::Mat& source, const Variant& variant) {
  const VariantFrame frame = variant_frame(source.size(), without_flip(variant));
  const VariantWarp resampling = resampling_of(source.size(), variant, frame);
  cv::Mat reduced = source, warped;
  if (resampling.reduced != source.size()) {
    cv::resize(source, reduced, resampling.reduced, 0, 0, cv::INTER_AREA);
  }
  if (resampling.warps) {
    cv::warpAffine(reduced, warped, resampling.reduced_from_variant, frame.size,
                   cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  } else {
    warped = reduced.data == source.data ? source.clone() : reduced;
  }
  // Flipped last and exactly: a flipped patch holds the very pixels of its twin.
  if (variant.flip) cv::flip(warped, warped, 1);
  return warped;
}

cv::Mat valid_mask(cv::Size source, const Variant& variant) {
  const VariantFrame frame = variant_frame(source, without_flip(variant));
  const VariantWarp resampling = resampling_of(source, variant, frame);
  cv::Mat mask(frame.size, CV_8U);
  const cv::Matx23d& m = resampling.reduced_from_variant;
  constexpr double kSlack = 1e-6;  // far below the 1/32 px in which cv::warpAffine counts
  const double right = resampling.reduced.width - 1 + kSlack, bottom = resampling.reduced.height - 1 + kSlack;
  for (int y = 0; y < mask.rows; ++y) {
    auto* row = mask.ptr<std::uint8_t>(y);
    for (int x = 0; x < mask.cols; ++x) {
      const double rx = m(0, 0) * x + m(0, 1) * y + m(0, 2);
      const double ry = m(1, 0) * x + m(1, 1) * y + m(1, 2);
      row[x] = rx >= -kSlack && rx <= right && ry >= -kSlack && ry <= bottom ? 255 : 0;
    }
  }
  if (variant.flip) cv::flip(mask, mask, 1);
  return mask;
}

}  // namespace freshet::vision
