// synth/scene/measured/sway_fit.h — the oscillator that explains how a plant's tip swayed.
#pragma once

#include <span>
#include <vector>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// What Eq. 4 needs to know of a plant, by TreeMotion's names.
struct SwayFit {
  double frequency_hz = 0, damping_per_s = 0, mass = 0;
  double deviation = 0;  // standard, of the tip as it was seen, lengths of the armature
  double noise = 0;      // its share in what was seen, of the variance
};

/// How much is seen at least, for a frequency to show: s.
inline constexpr double kLeastSeenS = 2;

/// The natural frequency, damping and mass under which this wind (Eq. 8, through Eq. 4) would most likely have moved
/// the tips as they were seen. No plant is found that swings slower than once in all that was seen, or faster than a
/// quarter of the frame rate.
///
/// tips       of one or more plants of a kind, displacements at every frame, lengths of the armature; kLeastSeenS long
///            at least, all of one length.
/// strength   of the force on them, a share of the wind's speed (force_strength).
/// Source     Whittle's likelihood of the mean Hann periodogram against the periodogram that is expected of so short a
///            series (Sykulski, Olhede, Guillaumin, Lilly, Early 2019), over a floor of noise and of what is small
///            beside the strongest. Damping shows worst: its deviation is about sqrt(2 damping / s seen); so it is held
///            to a tenth of critical (de Langre 2008) by a log-normal prior of a factor kDampingFactor.
/// Cost       .1 s for 200 frames, and as their square.
SwayFit fit_sway(std::span<const std::vector<float>> tips, double fps, const Wind& wind, double strength);

}  // namespace freshet::synth::scene
