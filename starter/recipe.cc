#include "starter/recipe.h"

#include <set>

#include <fmt/format.h>

#include "cache/result_cache.h"
#include "freshet/error.h"
#include "synth/simulate/design/scene_file.h"
#include "synth/toml/section.h"

namespace freshet::starter {
namespace {

/// Raised where the same recipe gives other bytes than before (tests/starter pins them): stores of old stay what they
/// were.
constexpr int kVersion = 1;

// clang-format off
constexpr const char* kOwn =
#include "embedded/starter.toml"
    ;
// clang-format on

}  // namespace

std::string Recipe::hash() const {
  cache::KeyHash hash;
  hash.add(kVersion);
  hash.add(text);
  return cache::hex(hash.key()).substr(0, 16);
}

Recipe own_recipe() { return parse_recipe(kOwn, "starter.toml"); }

Recipe parse_recipe(std::string_view text, const std::filesystem::path& name) {
  const synth::TomlText parsed(text, name, "Give a TOML file with a table [[clip]] for each clip");
  synth::Section file = parsed.root();
  synth::simulate::SceneOptions usual{.size = {320, 240}, .frames = 96};
  synth::Vec2 size{320, 240};
  file.read("size", size, {16.0, 4096.0});
  usual.size = {static_cast<int>(size.x), static_cast<int>(size.y)};
  file.read("frames", usual.frames, {1.0, 1e6});
  file.read("fps", usual.fps, {1.0, 240.0});
  Recipe recipe{.text = std::string(text), .clips = {}};
  std::set<std::string> names;
  for (synth::Section& row : file.tables("clip")) {
    const std::string clip = row.text("name").value_or("");
    if (clip.find('/') == clip.npos || clip.front() == '/' || clip.back() == '/' ||
        clip.find("..") != clip.npos)
      row.refuse_whole(fmt::format("its name \"{}\" does not say its class", clip),
                       "Give name = \"fire/candle\"");
    if (!names.insert(clip).second) row.refuse("name", "another clip has it", "Give each a name of its own");
    row.rename(clip);
    recipe.clips.push_back({clip, synth::simulate::read_clip(row, usual)});
    const cv::Size made = recipe.clips.back().scene.size;
    if (made.width % 2 != 0 || made.height % 2 != 0)
      row.refuse_whole(fmt::format("its size {} x {} is odd", made.width, made.height), "Give even sides");
  }
  file.done();
  if (recipe.clips.empty()) file.refuse_whole("no clip: the store would be empty", "Add a table [[clip]]");
  return recipe;
}

}  // namespace freshet::starter
