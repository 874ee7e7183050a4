// synth/judging/dents.h — whether a straight border of the fluid, such as a horizon, stays straight.
#pragma once

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Straight borders are those cells of the matte's outline that a line fits to half a pixel, and across which the
/// still's means differ by 12 grey levels. There, in a band of 6 px inside the fluid: how much of it shows what lies
/// beyond the border (luma nearer to that side's mean), less what of it does in the still, px of the judged film: the
/// mean depth of the dents. NaN where no border is straight. The map has those cells alone, by span.
Reading dents(const Evidence& film);

}  // namespace freshet::synth::judging
