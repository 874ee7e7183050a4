// stored/middle_frame.h — a clip as a person sees it, out of a store.
#pragma once

#include <opencv2/core.hpp>

#include "store/store.h"

namespace freshet::stored {

/// The frame in the middle of a clip: CV_8UC3, BGR, source size.
/// Throws  as ClipFrames.
cv::Mat middle_frame(const store::Snapshot& snapshot, store::ClipId clip);

}  // namespace freshet::stored
