// synth/animate/paper/paper_renderer.h — Okabe's own frames: the patches' differences on a long exposure of the
// picture.
#pragma once

#include <memory>

#include "synth/animate/blend/blend.h"
#include "synth/animate/clips/clip_layer.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/frames/renderer.h"
#include "synth/animate/frames/still_part.h"
#include "synth/animate/still/appearance.h"
#include "synth/animate/still/base_image.h"

namespace freshet::synth::animate {

enum class AppearanceMatching {
  kNone,
  kFrame,     // the paper's: each frame by itself; it pumps
  kSequence,  // one model for the whole animation
};

struct PaperOptions {
  Resampling resampling = Resampling::kFlow;
  BaseImageOptions base{};
  BlendOptions blend{};
  /// Contrast and levels brought to the picture's.
  AppearanceMatching matching = AppearanceMatching::kSequence;
  AppearanceOptions appearance{};
};

/// Source: Okabe et al. 2011, Sec. 6.
std::unique_ptr<Renderer> make_renderer(Animation& animation, const StillPart& still,
                                        const PaperOptions& options);

}  // namespace freshet::synth::animate
