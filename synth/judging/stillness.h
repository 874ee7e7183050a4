// synth/judging/stillness.h — what of the fluid does not move at all.
#pragma once

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Share of the matte whose luma deviates by less than one grey level over time; the map is the same by cell.
Reading stillness(const Evidence& film);

}  // namespace freshet::synth::judging
