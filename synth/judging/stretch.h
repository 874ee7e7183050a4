// synth/judging/stretch.h — how far the motion draws detail out, and where it folds.
#pragma once

#include "synth/judging/evidence.h"
#include "synth/judging/film_motion.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// The film's flow, composed over each run of frames, has a Jacobian at each place, with singular values s1 >= s2:
/// octaves of s1 / s2 (at most 4) that detail is drawn out by in a quarter of a second; 4 where it folds (the
/// determinant is not positive). Mean over the fluid, its map by cell and span.
/// The critic (critic.h) takes it over a shorter time where a film goes faster than its kind: what goes fast is renewed
/// sooner.
/// Flow is smoothed by sigma 2 px: Jacobians of pixels are noise.
Reading stretch(const Evidence& film, const FilmMotion& motion);

}  // namespace freshet::synth::judging
