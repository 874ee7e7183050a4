// synth/animate/carried/carried_renderer.h — motion from the patches, look from the picture: the picture is carried
// along the patches' motion.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "synth/animate/carried/innovations.h"
#include "synth/animate/clips/clip_layer.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/frames/renderer.h"
#include "synth/animate/frames/still_part.h"
#include "synth/animate/motion/carrying_field.h"
#include "synth/animate/still/base_image.h"
#include "synth/animate/still/carried_base.h"
#include "synth/animate/still/lost_contrast.h"

namespace freshet::synth::animate {

enum class Layout {
  /// By place and band as the layout of the patches there does (layout_shares); of clouds also where they would be
  /// torn, and all of it where a vortex is asked.
  kMeasured,
  kGoes,    // all goes
  kStands,  // its texture alone goes
};

/// How much lighter than usual patches are in an output frame, in the share that has begun: CV_32F of the picture's
/// size, luma.
struct LighterPatches {
  cv::Mat liveliest;  // of those around each place (SharedLevels::liveliest)
  cv::Mat here;       // those of a place itself
};

/// finish() calls it, where anything comes from the patches' pixels. From many threads.
struct LevelSink {
  std::function<void(int output, LighterPatches lighter)> take{};
  double deviation = 0;  // luma: over time, of LighterPatches::liveliest at any place, at most
};

struct CarriedOptions {
  Resampling resampling = Resampling::kFlow;
  BaseImageOptions base{};  // of what lies below the copies
  /// The motion, the copies of the picture that it carries, and the contrast that they lose.
  CarryingOptions carrying{};
  CarriedBaseOptions carry{};
  LostContrastOptions contrast{};
  /// How long detail lives that is carried along, s, until half of it is left; 0: as long as in the clips that are
  /// shown, of water .4 of that.
  double half_life_s = 0;
  /// How much shorter detail lives where the fluid is made to go faster than its patches (pace): lives are
  /// divided by pace to this power. Eddies of one size turn over in a time that falls as their speed rises. .5 and 1
  /// bring clouds' spectrum from 4.2 to 4.0 and 3.8 dB and all kinds nearer in detail; at 1 fire's lives are too short.
  double life_pace = 0.5;
  /// Of what stays in its place in the patches (standing_shares), how much the picture keeps, 0..1; 0: all that is
  /// fluid goes.
  double standing = 1;
  /// Whether the picture's layout stands and only its texture goes (StandingLayout), as in falls and rapids, or goes,
  /// as in seas, whose crests it is. It always goes with a moving outline.
  Layout layout = Layout::kMeasured;
  /// Of levels of 16 px and more, how much of what stands as measured is to stand, 0..1.
  double wide_layout = 1;
  /// CV_32F of the picture's size, 0..1: by how much less of the layout (LayoutShare) stands than measured. Empty:
  /// nowhere.
  cv::Mat freed{};
  /// Of the light of sparkles on water (Glitter), how much is lit and goes out in its place, 0..1; 0: all goes along.
  double glitter = 1;
  /// Whether the mean light and colour of wide places stay the still's (StandingColour). Not of flames by themselves,
  /// whose level is what they do.
  bool holds_light = true;
  /// What comes from the patches' pixels. Nothing: the motion alone, and no frame of a clip is read. For a first look:
  /// a third of the time.
  std::optional<InnovationOptions> innovations = InnovationOptions{};
  LevelSink level_sink{};
};

/// Copies of the picture are carried along the motion of the assigned patches (CopyMaps, CarriedBase), their contrast
/// is brought back, what stands in the patches stands in the picture (StandingDetail), and what comes anew in the
/// patches comes anew in it (Innovations). Where the layout stands, its texture alone is carried (StandingLayout,
/// LayoutShare). Light and colour of wide places are the picture's throughout (StandingColour), but where the patches'
/// wide forms go and live long, as clouds do: these go whole, but where they would be torn. Sparkles on water are lit
/// and go out where they are (Glitter).
/// Frame 0 is the picture.
/// Source: not in Okabe et al. 2011; see the parts.
std::unique_ptr<Renderer> make_renderer(Animation& animation, const StillPart& still,
                                        const CarriedOptions& options);

}  // namespace freshet::synth::animate
