// library/animation.h — a labelling's frames, in the form that whoever shows them asks for.
#pragma once

#include <functional>

#include <opencv2/core.hpp>

#include "freshet/animate.h"
#include "synth/animate/animate.h"

namespace freshet {

/// picture   what is rendered over: of the search's, with as many bits as the form has.
/// Throws    as freshet::animate.
synth::animate::AnimateReport render_animation(const Labelling& labelling, const AnimateOptions& options,
                                               const cv::Mat& picture, synth::animate::FrameForm form,
                                               const std::function<void(const cv::Mat&)>& sink,
                                               const Job& job);

}  // namespace freshet
