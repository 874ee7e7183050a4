// synth/animate/forms/form_choice.h — which clip's fire burns where the picture's does.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/animate/forms/clip_forms.h"
#include "synth/animate/forms/parted_still.h"
#include "synth/animate/forms/seats.h"

namespace freshet::synth::animate {

/// A rectangle of a clip's frames laid on one of the picture: bed on bed, axis on axis, as high and nearly as wide.
struct ChosenForm {
  std::size_t clip = 0;  // index into the clips
  cv::Rect from;         // px of the clip's frame
  cv::Rect2d to;         // px of the picture
  bool mirrored = false;
  std::uint32_t first = 0;  // the frame most like the picture: the animation begins with it
  double fit = 0;           // 0..1
  Seat seat;                // of the picture that it burns in, px
};

/// Likeness is the cosine between the picture's level and the clip's: its mean (the picture's blurred, for it is one
/// moment), and its most alike frame, half each; less where the clip would be enlarged, its frame cuts its flames, or
/// they are busier or plainer than the picture's.
/// Each seat of the picture chooses for itself; two of them take different moments.
/// still     of the picture.
/// clips     at least one; those without a seat are passed over.
/// seconds   of the clip that are to be left after the first frame, if it has so many.
/// Returns   one for each seat, from left to right; none where no clip shines.
std::vector<ChosenForm> choose_forms(const PartedStill& still, std::span<const ClipForms> clips,
                                     double seconds);

/// Of all forms, by how much of the light they stand for. 0 for none.
double overall_fit(std::span<const ChosenForm> forms);

}  // namespace freshet::synth::animate
