// synth/scene/scene_file.h — a scene of layers as a TOML file that a person edits.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/scene.h"
#include "synth/toml/range.h"

namespace freshet::synth::scene {

/// Reads a scene; files that it names lie beside it. What is drawn comes later (read_marks).
/// Throws Error{kInput} naming file, line, key and remedy: no TOML, an unknown key (and those there are), a value of
/// another kind or out of range, two layers of one name or order, a boat without water, two layers that are the rest.
Scene read_scene(const std::filesystem::path& path);
/// The same from text. name   stands for the file in messages.
Scene parse_scene(std::string_view text, const std::filesystem::path& name);

/// Every key with unit, range and default, for a person.
std::string scene_keys();

/// What a number of a scene may be. table   "wind", "wind.at", "layer" (what every layer has), or a kind of motion.
struct SceneRange {
  std::string table, key;
  Range range, slider;  // slider: the part in which one looks first
};
std::vector<SceneRange> scene_ranges();
/// Throws Error{kUsage} where there is no such number.
SceneRange scene_range(const std::string& table, const std::string& key);

/// A commented scene for this picture to start from. picture   as the scene names it.
std::string first_scene(const std::string& picture, cv::Size size);

}  // namespace freshet::synth::scene
