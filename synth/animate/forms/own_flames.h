// synth/animate/forms/own_flames.h — the picture's own flames, carried as light over the ground, which stands.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "store/store.h"
#include "synth/animate/carried/carried_renderer.h"
#include "synth/animate/forms/parted_still.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/frames/renderer.h"
#include "synth/animate/frames/still_part.h"

namespace freshet::synth::animate {

struct OwnFlamesOptions {
  CarriedOptions carried{};  // how the light is carried
  double handover_s = 0.2;   // after which nothing is left of what a picture of the light on black lacks
  double lighting = 0.5;     // how far the ground follows the light that falls on it by day, 0..1 (LitGround)
  std::vector<store::ClipId>
      clips{};      // of fire, the most like first: as theirs sway, so do tongues of the picture
  double pace = 1;  // clip seconds per second of the animation, of those
};

/// The picture's light is carried as a picture of its own, on black, would be, whose wide forms stand less than the
/// clips' do, and whose layout (LayoutShare) stands at its foot alone (tips_of): above it flames go up into the
/// dark, also from behind holes in the matte. Below its bed lies its mirror image, so that a foot burns on. Logs,
/// rims and embers do not move; they are lit by the flames (LitGround), and glow and glimmer place by place as the
/// liveliest patches around do (SharedLevels::liveliest): their level varies over time by at most .05 in the dark
/// and .006 by day, of a ground darker than .15 less.
/// Flames leap and die down where the patches there get lighter and darker than all of the fire's
/// (SharedLevels::here), in the colours that the picture's flames have at that level.
/// A flame of one tongue (tongues_of) is not carried but sways as a whole, as the flame of a clip did; of the first
/// kCourseClips clips that which is a tongue itself most often, or the calmest; as fast as asked (as_fast_as), else as
/// restless as halfway_to_usual. Where such flames have more than half of the light (share_of_light), the
/// rest stands. Frame 0 is the picture.
/// parted  of this picture, with contrast.
std::unique_ptr<Renderer> own_flames(Animation& animation, const StillPart& still, PartedStill parted,
                                     const OwnFlamesOptions& options);
inline constexpr std::size_t kCourseClips = 16;
inline constexpr std::uint32_t kCourseLook = 16, kCourseFrames = 150;  // of each clip, and of the chosen one

}  // namespace freshet::synth::animate
