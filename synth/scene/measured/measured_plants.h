// synth/scene/measured/measured_plants.h — plants of a scene that sway as plants of films do (Chuang et al. 2005,
// Sec. 5: motion from videos of similar objects).
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// Gives each layer that takes its motion from a film (TreeMotion::motion_from) the natural frequency, damping and mass
/// under which the scene's wind, at its strongest, moves the film's plant as the film shows it. Without such layers it
/// does nothing. A wind without turbulence sways nothing: the usual one is taken in its place.
///
/// notices   for a person: what was measured. Null: none.
/// Throws    Error{kInput} naming scene or film: as VideoReader and clip_sway; shorter than kLeastSeenS or 32 frames; a
///           plant that does not move, or is lost from sight. Error{kNotFound}: no such clip in the store.
///           Error{kDamaged}. Error{kCancelled}.
/// Cost      a pass over each film's first 1500 frames (clip_sway), and fit_sway.
void measure_plants(Scene& scene, std::vector<std::string>* notices = nullptr,
                    const std::stop_token& stop = {});

}  // namespace freshet::synth::scene
