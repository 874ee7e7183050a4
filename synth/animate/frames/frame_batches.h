// synth/animate/frames/frame_batches.h — all frames of an animation made by a renderer, batch by batch, and handed on.
#pragma once

#include <functional>

#include <opencv2/core.hpp>

#include "synth/animate/frames/animation.h"
#include "synth/animate/frames/renderer.h"
#include "synth/animate/frames/still_part.h"

namespace freshet::synth::animate {

/// In order, some at once while those before go into `sink`; mattes and motion into their own sinks, from this
/// thread. Of frames that are not wanted (FrameOptions::from) only what goes on from frame to frame is made.
/// Throws   what the sinks throw; Error{kCancelled}.
void make_frames(Animation& animation, const StillPart& still, Renderer& renderer,
                 const std::function<void(const cv::Mat&)>& sink);

}  // namespace freshet::synth::animate
