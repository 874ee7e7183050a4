// synth/matte/held.h — what stands in front of the fluid or beside it, taken out of the fluid's matte.
#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace freshet::synth::matte {

/// The fluid's matte less what is held back, softly: alpha * (1 - held), rounded; 0 where held is 255.
///
/// alpha, held   CV_8U, of one size.
/// where         what holds, for messages.
/// Throws        Error{kInput} when less than 1 % of the matte is left: nothing would move.
cv::Mat less_held(const cv::Mat& alpha, const cv::Mat& held, const std::string& where);

}  // namespace freshet::synth::matte
