// synth/scene/measured/clip_sway.h — how the tips of plants in a film sway.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// The tip of each plant in each frame of a film: displacements since the first, lengths of its armature, to the right
/// of the way from root to tip, as TreeSway::tip.
///
/// next        the film's frames, CV_8U luma of one size; nothing after the last.
/// armatures   root to tip, px, as the plants stand in the first frame; part of them may lie outside of it, and then
///             tells nothing. What is bent as Eq. 3 says has one tip: the median along the armature, by how far each
///             point is bent.
/// Throws      Error{kInput} naming `film`: an armature outside of it; frames of unequal size.
/// Source      optical flow (DIS) from the first frame to each, begun from the one before or anew, whichever explains
///             the armatures better: nothing adds up over time.
/// Cost        30 ms a frame, whatever its size: what lies about the armatures is reduced to 320 px.
std::vector<std::vector<float>> clip_sway(const std::function<std::optional<cv::Mat>()>& next,
                                          const std::vector<Line>& armatures, const std::string& film);

}  // namespace freshet::synth::scene
