// synth/judging/seams.h — hard seams: edges that are steeper than any the still has near them.
#pragma once

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Share of the fluid, in thousandths, whose step to the next pixel is by kSeamStep grey levels above the steepest step
/// that the still has within an eighth of its longer side. Detail that is carried, blurred or mixed gets no steeper; a
/// place where two pictures meet does. The map is the same by cell and span.
inline constexpr int kSeamStep = 12;
Reading seams(const Evidence& film);

}  // namespace freshet::synth::judging
