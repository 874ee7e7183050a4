// synth/judging/detail_loss.h — fog: where the film has less detail than the still.
#pragma once

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Octaves that |Laplacian| of the two finest levels lies below the still's, by cell, and the mean of what is lost over
/// cells and spans of time: what one place gains does not make good what another loses. Detail moves, so a cell is
/// compared with the mean of the still's cells around it; cells whose still has less than a grey level of detail have
/// none to lose.
Reading detail_loss(const Evidence& film);

}  // namespace freshet::synth::judging
