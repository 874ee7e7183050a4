#include "synth/scene/printed_scene.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "freshet/error.h"
#include "synth/scene/scene_file.h"
#include "synth/toml/section.h"

namespace freshet::synth::scene {
namespace {

constexpr const char* kRemedy =
    "Give a TOML file; freshet synth scene --init PICTURE -o SCENE.toml makes one";
constexpr std::array kPrintedMotions{"still", "tree", "water", "boat", "clouds"};

std::string typed(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& each) { text << each; });
  return text.str();
}

/// Whether a key says what is printed: numbers by their values.
bool says(const toml::node& given, const toml::node& printed) {
  const auto a = given.value<double>(), b = printed.value<double>();
  return a && b ? *a == *b : typed(given) == typed(printed);
}

class Printing {
 public:
  explicit Printing(const std::filesystem::path& file) : file_(file) {}

  void print(toml::table& scene) const {
    if (scene.get("wind") == nullptr) scene.insert("wind", toml::table());
    toml::table& wind = *scene.get_as<toml::table>("wind");
    print(wind, "wind", "wind");
    if (const toml::node* const at = wind.get("at"))
      Section(file_, wind, "wind")
          .refuse(*at, "at", "contradicts --as-printed: the paper's wind stays as it is (Sec. 3.2)",
                  "Leave the tables [[wind.at]] out, or --as-printed");
    for (toml::node& node : *scene.get_as<toml::array>("layer")) {
      toml::table& layer = *node.as_table();
      const std::string motion = layer["motion"].value_or(std::string()),
                        name = fmt::format("layer ({})", layer["name"].value_or(std::string()));
      if (std::ranges::find(kPrintedMotions, motion) == kPrintedMotions.end())
        Section(file_, layer, name)
            .refuse(*layer.get("motion"), "motion",
                    fmt::format("\"{}\" is none of the paper's motions", motion),
                    "Leave the layer out, or --as-printed");
      if (const toml::node* const shadow = layer.get("shadow"))
        Section(file_, layer, name)
            .refuse(*shadow, "shadow", "contradicts --as-printed: the paper's layers cast none (Sec. 5)",
                    "Leave the key out, or --as-printed");
      if (const toml::node* const glow = layer.get("glow"))
        Section(file_, layer, name)
            .refuse(*glow, "glow", "contradicts --as-printed: the paper's layers light none",
                    "Leave the key out, or --as-printed");
      if (const toml::node* const film = layer.get("motion_from"))
        Section(file_, layer, name)
            .refuse(*film, "motion_from",
                    "contradicts --as-printed: the paper's plants learn from no film (Sec. 5)",
                    "Leave the key out, or --as-printed");
      print(layer, motion, name);
    }
  }

 private:
  void print(toml::table& table, const std::string& kind, const std::string& name) const {
    for (const PrintedKey& printed : printed_keys()) {
      if (printed.table != kind) continue;
      const toml::table parsed = toml::parse("value = " + printed.value);
      const toml::node& value = *parsed.get("value");
      const toml::node* const given = table.get(printed.key);
      if (given != nullptr && !says(*given, value))
        Section(file_, table, name)
            .refuse(*given, printed.key,
                    fmt::format("{} contradicts --as-printed: the paper prints {} ({})", typed(*given),
                                printed.value, printed.where),
                    "Leave the key out, or --as-printed");
      if (given == nullptr) value.visit([&](const auto& each) { table.insert(printed.key, each); });
    }
  }

  const std::filesystem::path& file_;
};

}  // namespace

const std::vector<PrintedKey>& printed_keys() {
  static const std::vector<PrintedKey> keys{
      {"wind", "gustiness", "0", "Sec. 3.2"},   {"tree", "plant", "\"tree\"", "Sec. 3.2"},
      {"tree", "shimmer", "0", "Sec. 3.2"},     {"water", "mapping", "\"displacement\"", "Eq. 10"},
      {"water", "against", "1", "Eq. 11"},      {"water", "edge", "\"moving\"", "Sec. 2"},
      {"water", "mirrors", "false", "Sec. 5"},  {"water", "calm", "0", "Sec. 5"},
      {"boat", "in_3d", "false", "Sec. 3.4"},   {"boat", "reflection_of", "\"\"", "Sec. 5"},
      {"clouds", "far_speed", "1", "Sec. 3.5"}, {"clouds", "shade", "0", "Sec. 5"}};
  return keys;
}

Scene parse_printed_scene(std::string_view text, const std::filesystem::path& name) {
  parse_scene(text, name);  // whose messages know the lines
  toml::table scene = toml::parse(text);
  Printing(name).print(scene);
  std::ostringstream printed;
  printed << scene;
  return parse_scene(printed.str(), name);
}

Scene read_printed_scene(const std::filesystem::path& path) {
  return parse_printed_scene(toml_file_text(path, kRemedy), path);
}

}  // namespace freshet::synth::scene
