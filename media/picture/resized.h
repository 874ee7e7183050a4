// media/picture/resized.h — frames in another size than they were made in.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::media {

/// What the colours of a frame with alpha are.
enum class Colours { kStraight, kPremultiplied };

/// Each pixel the mean of what it covers where sides shrink, Lanczos over 8 x 8 pixels where they grow; values stay in
/// their range (light has no end above). Colours are weighted by their alpha, so that what is not seen does not bleed
/// in.
///
/// frame     CV_8U, CV_16U or CV_32F, 1, 3 or 4 channels; of 4 the last is alpha.
/// size      px. The frame itself where it has that size already.
cv::Mat resized(const cv::Mat& frame, cv::Size size, Colours colours = Colours::kPremultiplied);

}  // namespace freshet::media
