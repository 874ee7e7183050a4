// synth/simulate/design/preset_scenes.cc — scenes to begin with.
#include <array>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/simulate/design/scene_file.h"

namespace freshet::synth::simulate {
namespace {

struct Named {
  const char *name, *summary, *text;
};

// clang-format off
constexpr std::array kDesigns{
    Named{"plume", "smoke that rises from a vent and curls",
#include "embedded/plume.toml"
    },
    Named{"fireball", "a blast that rises and rolls into a mushroom",
#include "embedded/fireball.toml"
    },
    Named{"firepit", "tongues of flame over a bed of logs",
#include "embedded/firepit.toml"
    },
    Named{"waterfall-pool", "water that falls over a brink into a pool and spreads",
#include "embedded/waterfall-pool.toml"
    },
    Named{"dragon-breath", "a jet of fire that shoots sideways and billows",
#include "embedded/dragon-breath.toml"
    }};
// clang-format on

std::string clip_summary(SceneKind kind) {
  switch (kind) {
    case SceneKind::kSmoke:
      return "a clip of smoke, lit, from a few vents";
    case SceneKind::kFire:
      return "a clip of flames with sparks";
    case SceneKind::kInk:
      return "a clip of ink in water";
    case SceneKind::kWaterfall:
      return "a clip of a waterfall over rock, from the front";
    case SceneKind::kRiver:
      return "a clip of a river with rocks";
    case SceneKind::kClouds:
      return "a clip of clouds in the wind";
    case SceneKind::kSea:
      return "a clip of waves under a low sun";
    case SceneKind::kRain:
      return "a clip of rain on a pool";
    case SceneKind::kFountain:
      return "a clip of a fountain's jets";
    case SceneKind::kBreakers:
      return "a clip of waves that break on a beach";
    case SceneKind::kDesign:
      break;
  }
  return {};
}

}  // namespace

std::vector<PresetScene> preset_scenes() {
  std::vector<PresetScene> result;
  for (const Named& each : kDesigns) result.push_back({each.name, each.summary});
  for (const SceneKind kind : all_clip_kinds())
    result.push_back({std::string(scene_kind_name(kind)), clip_summary(kind)});
  return result;
}

std::string preset_scene(std::string_view name) {
  for (const Named& each : kDesigns)
    if (name == each.name) return fmt::format("# {}: {}\n{}", each.name, each.summary, each.text);
  std::string names;
  for (const PresetScene& each : preset_scenes()) names += (names.empty() ? "" : ", ") + each.name;
  for (const SceneKind kind : all_clip_kinds()) {
    if (name != scene_kind_name(kind)) continue;
    const SceneOptions scene;
    return fmt::format(
        "# {}: {}. The seed decides its sources, winds, speeds and colours\nclip = \"{}\"\nsize = [{}, {}]\n"
        "frames = {}\nfps = {}\nseed = {}\n",
        name, clip_summary(kind), name, scene.size.width, scene.size.height, scene.frames, scene.fps,
        scene.seed);
  }
  throw Error(ErrorKind::kUsage, "preset", fmt::format("'{}' is not known", name),
              fmt::format("Choose one of {}, or give a scene file (.toml)", names));
}

}  // namespace freshet::synth::simulate
