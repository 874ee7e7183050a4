// synth/judging/pulse.h — whether the fluid's level beats as a whole.
#pragma once

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Deviation over time of the matte's mean luma, less its straight trend (which colour_drift has), grey levels; the map
/// is the same of each cell, over all time. Flames beat by several levels, water and clouds by less than one.
Reading pulse(const Evidence& film);

}  // namespace freshet::synth::judging
