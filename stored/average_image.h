// stored/average_image.h — a clip's representative image out of a store.
#pragma once

#include <opencv2/core.hpp>

#include "store/store.h"

namespace freshet::stored {

/// The average over time of a clip's luma: CV_8U, source size. Kept with 16 bits, rounded to 8 here:
/// descriptors are computed on 8 bits, of clips as of a target picture.
/// Throws   Error{kDamaged} when the stream is not one plane of 16 bits of the clip's size.
cv::Mat average_image(const store::Snapshot& snapshot, store::ClipId clip);

}  // namespace freshet::stored
