// stored/clip_region.h — a rectangle of a clip's frames, as a player shows it.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "media/frame/frame.h"
#include "store/store.h"

namespace freshet::stored {

enum class Shown { kBgr, kLuma };  // CV_8UC3 as media::to_bgr, CV_8U as media::to_luma

/// Frames [first, first + count) of a rectangle, to the bit what whole frames show there. Decodes the tiles under the
/// rectangle and a margin of 8 px alone, on the calling thread; of frames of odd sides with fewer samples of chroma
/// all.
/// layout   ClipFrames::layout of the clip.
/// region   px, inside the frame.
/// Throws   Error{kDamaged}.
std::vector<cv::Mat> read_region(const store::Snapshot& snapshot, store::ClipId clip,
                                 const media::PixelLayout& layout, cv::Rect region, std::uint32_t first,
                                 std::uint32_t count, Shown shown);

}  // namespace freshet::stored
