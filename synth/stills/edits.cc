#include "synth/stills/edits.h"

#include <algorithm>

#include <fmt/format.h>

#include "freshet/error.h"
#include "synth/toml/keys.h"

namespace freshet::synth::stills {
namespace {

constexpr const char* kRemedy = "Give a TOML file; freshet synth stills --keys explains what it may say";

using Names = std::vector<std::string>;

Names names_in(const Section& section, const toml::node& node, const std::string& key, std::size_t least) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() < least || list->size() > 10000)
    section.refuse(node, key, fmt::format("a list of at least {} names of stills is expected", least));
  Names names;
  for (const toml::node& each : *list) {
    if (!each.is_string()) section.refuse(each, key, "the name of a still is expected, in quotes");
    names.push_back(each.ref<std::string>());
  }
  return names;
}

std::vector<Names> lists_in(Section& section, const std::string& key, std::size_t least, std::size_t most) {
  std::vector<Names> lists;
  const toml::node* node = section.find(key);
  if (node == nullptr) return lists;
  const toml::array* list = node->as_array();
  if (list == nullptr) section.refuse(*node, key, "a list of lists of stills is expected");
  for (const toml::node& each : *list) {
    lists.push_back(names_in(section, each, key, least));
    if (lists.back().size() > most)
      section.refuse(each, key,
                     fmt::format("it names {} stills, at most {} are expected", lists.back().size(), most));
  }
  return lists;
}

void take_kind(RegionEdits& edits, std::size_t word) {
  constexpr RegionKind kKinds[] = {RegionKind::kIndependent, RegionKind::kSlow, RegionKind::kStanding};
  edits.kind = kKinds[word];
}

const std::vector<Key<RegionEdits>>& region_keys() {
  static const std::vector<Key<RegionEdits>> keys{
      {"speed", &RegionEdits::speed, {.05, 20}, "", "times as fast", "--speed"},
      {"step", &RegionEdits::step_s, {.04, 60}, "s", "mean time from still to still", "--step"},
      {"sigma",
       &RegionEdits::sigma,
       {1e-4, 100},
       "",
       "how freely the sequence departs from the paths (Eq. 2)",
       "--sigma"},
      {"irregularity",
       &RegionEdits::irregularity,
       {0, 1},
       "",
       "chance that a turn within a path is accepted",
       "--irregularity"},
      {"slow_turns",
       &RegionEdits::slow_turns,
       {},
       "",
       "true: slow down before a turn, gather speed after it",
       "true"},
      {"kind",
       Words<RegionEdits>{{"independent", "slow", "standing"}, take_kind},
       {},
       "",
       "how the region moves",
       "as found"},
      {"split",
       &RegionEdits::split,
       {1, 8},
       "",
       "parts of the region that move half by themselves",
       "--split"}};
  return keys;
}

/// A place in a still.
template <cv::Point2d StillPin::*place>
void read_place(Section& section, StillPin& pin, const char* key) {
  Vec2 value{};
  if (section.read(key, value, {0, 100000})) pin.*place = {value.x, value.y};
}

const std::vector<Key<StillPin>>& pin_keys() {
  static const std::vector<Key<StillPin>> keys{
      {"from", &StillPin::from, {}, "", "the still in which `at` is", kNeeded},
      {"to", &StillPin::to, {}, "", "the still in which `goes` is", kNeeded},
      {"at",
       [](Section& section, StillPin& pin) { read_place<&StillPin::at>(section, pin, "at"); },
       {},
       "px",
       "[x, y] of a point in `from`, as the file is shown upright; [0, 0] is the upper left pixel",
       kNeeded},
      {"goes",
       [](Section& section, StillPin& pin) { read_place<&StillPin::goes>(section, pin, "goes"); },
       {},
       "px",
       "[x, y] of the same point in `to`",
       kNeeded},
      {"reach",
       &StillPin::reach,
       {1, 100000},
       "px",
       "the flow changes so far from `at`, and no farther; more for large things",
       ".08 of the longer side"}};
  return keys;
}

const std::vector<Key<FrontEdit>>& front_keys() {
  static const std::vector<Key<FrontEdit>> keys{
      {"name",
       &FrontEdit::name,
       {},
       "",
       "what it is called; a [[region]] of this name says how it goes",
       kNeeded},
      {"mattes",
       &FrontEdit::mattes,
       {},
       "",
       "a folder of grey pictures named as the stills, white where the thing is; a still without one does "
       "not show it",
       kNeeded}};
  return keys;
}

RegionEdits read_region(Section& section) {
  RegionEdits edits;
  read_keys(section, region_keys(), edits, "");
  edits.refuse = lists_in(section, "refuse", 2, 10000);
  edits.turn = lists_in(section, "turn", 2, 10000);
  edits.order = lists_in(section, "order", 2, 10000);
  edits.cut = lists_in(section, "cut", 2, 2);
  if (const toml::node* node = section.find("sequence"))
    edits.sequence = names_in(section, *node, "sequence", 2);
  return edits;
}

bool in_order(const std::vector<int>& some, const Path& path) {
  std::size_t met = 0;
  for (const int still : path)
    if (met < some.size() && still == some[met]) ++met;
  return met == some.size();
}

std::vector<int> numbers_of(const Names& some, const Names& names, const std::string& key) {
  std::vector<int> out;
  for (const std::string& name : some) out.push_back(still_named(name, names, key));
  return out;
}

}  // namespace

StillsEdits read_edits(const std::filesystem::path& path) {
  const TomlText text(toml_file_text(path, kRemedy), path, kRemedy);
  Section root = text.root();
  StillsEdits edits;
  std::vector<RegionEdits>& all = edits.regions;
  all.push_back(read_region(root));
  for (Section& section : root.tables("region")) {
    const std::optional<std::string> name = section.text("name");
    if (!name) section.refuse_whole("it does not say which region it is", "Add name = \"1\"");
    section.rename(*name);
    all.push_back(read_region(section));
    all.back().region = *name;
    section.done();
  }
  for (Section& section : root.tables("pin", 1000)) {
    StillPin& pin = edits.pins.emplace_back();
    read_keys(section, pin_keys(), pin,
              "A pin is from = \"a.jpg\", to = \"b.jpg\", at = [x, y], goes = [x, y]");
    section.done();
  }
  for (Section& section : root.tables("front", 32)) {
    read_keys(section, front_keys(), edits.fronts.emplace_back(),
              "A thing in front is name = \"heron\", mattes = \"heron\"");
    section.done();
  }
  root.done();
  return edits;
}

std::string edit_keys() {
  return "What an edits file may say, at its top for all regions, or below [[region]] for the one called "
         "`name`:\n\n" +
         key_lines(key_texts(region_keys())) + R"(
refuse = [["a.jpg", "c.jpg"]]           paths that hold these stills in this order, or its reverse, are not walked
turn = [["c.jpg", "a.jpg"]]             paths that hold them are walked in this order alone
order = [["a.jpg", "b.jpg", "c.jpg"]]   a path more
cut = [["a.jpg", "d.jpg"]]              these two stills are not alike: no step leads from one to the other
sequence = ["a.jpg", "b.jpg", "a.jpg"]  show the stills in this order; nothing is drawn

[[region]]
name = "2"          as the page and the sheet call it; what holds for a region holds for its parts
speed = 0.5

Below [[pin]], where something of one still lies in another. Flow leads from the one to the other, and back:

)" + key_lines(key_texts(pin_keys())) +
         R"(
[[pin]]
from = "a.jpg"
to = "b.jpg"
at = [412, 230]
goes = [530, 218]

Below [[front]], a thing that passes before others, nearest first. It is taken out of the stills and goes by itself;
what it hides is filled from stills that show it:

)" + key_lines(key_texts(front_keys())) +
         R"(
[[front]]
name = "heron"
mattes = "heron"
)";
}

RegionEdits edits_of(const std::vector<RegionEdits>& all, const Region& region) {
  RegionEdits out;
  out.region = region.name;
  const auto over = [](auto& value, const auto& by) {
    if (by) value = by;
  };
  const auto append = [](auto& list, const auto& by) { list.insert(list.end(), by.begin(), by.end()); };
  for (const RegionEdits& each : all) {
    if (each.region != "*" && each.region != region.name && each.region != region.parent) continue;
    over(out.speed, each.speed);
    over(out.step_s, each.step_s);
    over(out.sigma, each.sigma);
    over(out.irregularity, each.irregularity);
    over(out.slow_turns, each.slow_turns);
    // Said of all regions, these two are meant for what moves.
    if (each.region != "*" || region.kind == RegionKind::kIndependent)
      over(out.kind, each.kind), over(out.split, each.split);
    append(out.refuse, each.refuse);
    append(out.turn, each.turn);
    append(out.order, each.order);
    append(out.cut, each.cut);
    if (!each.sequence.empty()) out.sequence = each.sequence;
  }
  return out;
}

int still_named(const std::string& name, const std::vector<std::string>& names, const std::string& where) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<int>(at - names.begin());
  throw Error(ErrorKind::kInput, where, fmt::format("there is no still \"{}\"", name),
              fmt::format("There are {}", fmt::join(names, ", ")));
}

std::vector<Path> edited_paths(const std::vector<Path>& paths, const RegionEdits& edits,
                               const std::vector<std::string>& names) {
  std::vector<Path> out = paths;
  for (const Names& each : edits.refuse) {
    const std::vector<int> some = numbers_of(each, names, "refuse");
    const std::size_t left = std::erase_if(
        out, [&](const Path& path) { return in_order(some, path) || in_order(some, reversed(path)); });
    if (left == 0)
      throw Error(ErrorKind::kInput, "refuse",
                  fmt::format("no path holds {} in this order", fmt::join(each, ", ")),
                  "The page lists the paths");
  }
  for (const Names& each : edits.order) {
    const std::vector<int> path = numbers_of(each, names, "order");
    out.push_back(path);
    out.push_back(reversed(path));
  }
  out = without_contained(out);
  for (const Names& each : edits.turn) {
    const std::vector<int> some = numbers_of(each, names, "turn");
    const bool known =
        std::any_of(out.begin(), out.end(), [&](const Path& path) { return in_order(some, path); });
    if (!known)
      throw Error(ErrorKind::kInput, "turn",
                  fmt::format("no path holds {} in this order", fmt::join(each, ", ")),
                  "The page lists the paths; give an order that is none yet as order = [...]");
    std::erase_if(out, [&](const Path& path) { return in_order(some, reversed(path)); });
  }
  return out;
}

}  // namespace freshet::synth::stills
