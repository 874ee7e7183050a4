// synth/scene/scene.h — a picture as layers that one wind moves: what a scene file says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "media/frame/blend.h"
#include "synth/scene/kinds/boat.h"
#include "synth/scene/kinds/clouds.h"
#include "synth/scene/kinds/footage.h"
#include "synth/scene/kinds/line.h"
#include "synth/scene/kinds/patches.h"
#include "synth/scene/kinds/still.h"
#include "synth/scene/kinds/transfer.h"
#include "synth/scene/kinds/tree.h"
#include "synth/scene/kinds/water.h"

namespace freshet::synth::scene {

/// What the wind has become at a moment; what a key leaves out, it leaves alone.
struct WindKey {
  double time_s = 0;  // from the film's beginning; above 0, growing from key to key
  std::optional<double> speed_m_per_s{}, direction_deg{}, gustiness{};
};

/// One for all layers.
struct Wind {
  double speed_m_per_s = 5;  // mean
  double direction_deg = 0;  // where it blows to, seen from above: 0 right, 90 away from the viewer, 180 left
  double turbulence = 0.25;  // standard deviation of its speed, fractions of the mean
  double kappa_m = 100;      // Eq. 8: at speed / kappa hertz its spectrum begins to fall
  double gustiness =
      0;  // 0: every layer has turbulence of its own (the paper); 1: all of it crosses the picture
  double width_m = 30;  // of the picture, for gusts that cross it
  std::uint64_t seed = 1;
  /// Weather that changes: speed, direction and gustiness above are those at time 0, and go on to these (weather.h).
  std::vector<WindKey> at{};

  bool changes() const { return !at.empty(); }
};

/// Where a layer's matte comes from.
struct MatteFrom {
  enum class Kind {
    kRest,       // what the other layers leave; the furthest layer
    kFile,       // a grey picture, or one with alpha: white where the layer is
    kScribbles,  // strokes on the layer (white, green) and beside it (black, red)
    kTrimap,     // white the layer, black not, grey unknown
    kPaint,      // the layer of this name in the scene's .ora: paint is the layer
  };
  Kind kind = Kind::kRest;
  bool painted = false;          // of kPaint: its colours are the paint's, and not the picture's below it
  std::filesystem::path file{};  // of kFile, kScribbles, kTrimap
};

using media::Blend, media::kBlends;

/// How a layer moves: one of the kinds in kinds/.
using LayerMotion = std::variant<StillMotion, TreeMotion, WaterMotion, BoatMotion, CloudMotion, PatchesMotion,
                                 TransferMotion, FootageMotion>;

struct SceneLayer {
  std::string name;  // unique; letters, digits, '-', '_' and spaces
  int order = 0;     // 1 is nearest; unique
  MatteFrom matte;
  std::uint64_t seed = 0;  // of its own; differs between layers
  LayerMotion motion{};
  Blend blend = Blend::kOver;
  /// From where it stands to where the shadow of its top falls, px; nothing: it casts none.
  std::optional<Line> shadow{};
  double shadow_darkness = 0.4;                // of the light that it takes, fractions
  std::optional<double> shadow_softness_px{};  // deviation; nothing: a 20th of its length
  bool shadow_in_still = true;                 // false: the still does not show it, and it is added
  double glow = 0;  // of what its light exceeds that of its first frame with any: share that falls around it
  std::optional<double> glow_reach_px{};  // nothing: a fifth of the picture's longer side

  /// "still", "tree", ...
  const char* kind() const {
    return std::visit([](const auto& each) { return each.kName; }, motion);
  }
  Pixels pixels() const {
    return std::visit([](const auto& each) { return each.kPixels; }, motion);
  }
  bool is_cut() const { return pixels() != Pixels::kOwn; }
  bool brings_frames() const { return pixels() != Pixels::kCut; }
  /// Its motion; null where it is of another kind.
  template <class Kind>
  const Kind* as() const {
    return std::get_if<Kind>(&motion);
  }
  template <class Kind>
  Kind* as() {
    return std::get_if<Kind>(&motion);
  }
};

struct Scene {
  std::filesystem::path file;     // itself, for messages
  std::filesystem::path picture;  // the still
  std::filesystem::path marks{};  // SVG over it; empty: lines stand in the scene file
  std::filesystem::path paint{};  // .ora with a layer of paint for layers whose matte is kPaint
  /// .ora of cut layers, as `freshet synth layers` wrote it and a person may have painted over it; empty: they
  /// are cut from the picture.
  std::filesystem::path cut{};
  Wind wind;
  int frames = 96;
  double fps = 25;
  bool loop = false;
  std::vector<SceneLayer> layers;  // nearest first
};

}  // namespace freshet::synth::scene
