// stored/patch_video.h — a patch over time, as its variant shows it.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "media/frame/frame.h"
#include "store/store.h"
#include "stored/clip_region.h"
#include "vision/variant.h"

namespace freshet::stored {

/// A square of a variant's frame, in some frames of its clip.
struct PatchPlace {
  store::ClipId clip;
  vision::Variant variant;
  cv::Point corner;                    // px, upper left, in the variant's frame
  int side = 48;                       // px
  std::uint32_t first = 0, count = 0;  // frames
};

/// Patches of an unscaled, unrotated variant are the clip's own pixels, flipped or not. Others are reduced by area and
/// interpolated linearly; they differ from vision::warp_to_variant by where areas begin.
/// layout   of the clip.
/// out      count x side x side, CV_8UC3 for Shown::kBgr and CV_8U for Shown::kLuma; overwritten.
/// Cost     some 3 ms of one core for 96 frames of 48 px. Safe from many threads. Throws Error{kDamaged}.
void read_patch(const store::Snapshot& snapshot, const media::PixelLayout& layout, const PatchPlace& place,
                Shown shown, cv::Mat& out);

}  // namespace freshet::stored
