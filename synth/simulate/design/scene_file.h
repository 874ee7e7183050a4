// synth/simulate/design/scene_file.h — a scene as a TOML file that a person edits, and the presets.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "synth/simulate/scene/scene_options.h"
#include "synth/toml/section.h"

namespace freshet::synth::simulate {

/// The text of a scene file. Throws Error{kInput} for what is no regular file of at most 4 MiB.
std::string scene_text(const std::filesystem::path& path);

/// Reads a scene. Pictures that it names are looked for beside it.
/// Throws Error{kInput} naming file, line and key: no TOML, an unknown key (and those there are), a value of
/// another kind or out of range, a shape outside the picture, a picture that cannot be read.
SceneOptions read_scene(const std::filesystem::path& path);
/// The same from text.
/// name   stands for the file in messages.
SceneOptions parse_scene(std::string_view text, const std::filesystem::path& name);

/// A table of another file that describes a ready-made clip by the same keys (size, frames, fps, seed, clip, speed,
/// zoom,
/// amount). usual   holds for those that it leaves out. Throws as read_scene, and for keys of a design.
SceneOptions read_clip(Section& table, const SceneOptions& usual);

/// Whether a name is that of a scene file, and not of a preset: it ends in .toml.
bool names_scene_file(const std::filesystem::path& scene);
/// The scene file, or the preset. Throws as read_scene and preset_scene.
SceneOptions named_scene(const std::filesystem::path& scene);

/// Every key with unit, range and default, for a person.
std::string scene_keys();

struct PresetScene {
  std::string name, summary;
};
/// Designs first, then the ready-made clips.
std::vector<PresetScene> preset_scenes();
/// The preset as the text of a scene file. Throws Error{kUsage} that lists the presets.
std::string preset_scene(std::string_view name);

}  // namespace freshet::synth::simulate
