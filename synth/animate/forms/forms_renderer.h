// synth/animate/forms/forms_renderer.h — forms from footage, look from the picture: flames of clips burn over the
// picture's ground.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "synth/animate/carried/carried_renderer.h"
#include "synth/animate/frames/animation.h"
#include "synth/animate/frames/renderer.h"
#include "synth/animate/frames/still_part.h"

namespace freshet::synth::animate {

/// Whose flames burn: clips', or the picture's own, carried as light (own_flames).
enum class Flames { kClips, kOwn };

struct FormsOptions {
  Flames flames = Flames::kClips;
  CarriedOptions carried{};  // how the picture's own flames go
  /// Clips of the store that are not shown, by name. All others of class fire may be, those of the placement first.
  std::vector<std::string> excluded{};
  bool placed_only = false;  // of the placement's clips alone
  double handover_s = 0.2;   // after which nothing of the picture's own flames is left
  double lighting = 0.5;     // how far the ground follows the light that falls on it by day, 0..1 (LitGround)
};

/// Flames over the ground that they shine on, which stands. With kOwn, own_flames. With kClips
/// the picture is parted into what shines and what it shines on (PartedStill); each fire in it gets the clip whose
/// flames fit best (choose_forms), in the picture's levels and colours (LevelMaps, LightColours), over its ground
/// (FormFrames). Frame 0 is the picture. Of the placement, its clips and their mean speed are used; strokes are not.
/// Where the clips fit badly the report says why (forms_lack).
/// Throws   Error{kInput} when the picture or the clips have no flames, or the outline is a moving one.
/// Source: the task is Okabe et al. 2011, Sec. 8 ("large features"); the method is ours.
std::unique_ptr<Renderer> make_renderer(Animation& animation, const StillPart& still,
                                        const FormsOptions& options);

/// As make_renderer, where the picture is of a fire: most patches of the placement are of class fire, and the picture
/// has flames that are lighter by kLeastContrast than what is around them. Else null.
std::unique_ptr<Renderer> fire_renderer(Animation& animation, const StillPart& still,
                                        const FormsOptions& options);

}  // namespace freshet::synth::animate
