// synth/scene/printed_scene.h — a scene file read as Chuang et al. 2005 print their method.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "synth/scene/scene.h"

namespace freshet::synth::scene {

/// A key, and its value as printed. table   "wind", or a kind of motion.
struct PrintedKey {
  std::string table, key, value;  // value as TOML has it
  std::string where;              // "Eq. 10"
};
const std::vector<PrintedKey>& printed_keys();

/// As read_scene; keys that are not given have their printed values.
/// Throws  Error{kInput} as read_scene, and naming file, line and key of what says otherwise, or a layer whose motion
///         is none of the paper's.
Scene read_printed_scene(const std::filesystem::path& path);
/// The same from text. name   stands for the file in messages.
Scene parse_printed_scene(std::string_view text, const std::filesystem::path& name);

}  // namespace freshet::synth::scene
