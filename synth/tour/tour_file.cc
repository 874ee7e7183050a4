#include "synth/tour/tour_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/toml/keys.h"

namespace freshet::synth::tour {
namespace {

constexpr const char* kRemedy = "Give a TOML file; freshet synth tour --keys explains it";
constexpr const char* kExplained = "freshet synth tour --keys explains it";
constexpr std::size_t kMaxKeys = 256, kMaxThings = 16;
constexpr double kPlaces = 1e5;  // px, and heights of the camera

template <std::size_t N>
void read_numbers(Section& section, const char* key, std::optional<std::array<double, N>>& into,
                  Range range) {
  const toml::node* node = section.find(key);
  if (node == nullptr) return;
  const std::vector<double> values = section.numbers(*node, key, N, range);
  into.emplace();
  std::ranges::copy(values, into->begin());
}

void read_vanishing(Section& section, TourPlan& plan) {
  read_numbers(section, "vanishing", plan.vanishing, {-kPlaces, kPlaces});
}
void read_rectangle(Section& section, TourPlan& plan) {
  read_numbers(section, "rectangle", plan.rectangle, {-kPlaces, kPlaces});
}
void read_move(Section& section, TourPlan& plan) {
  if (const auto word = section.word("move", move_names())) plan.move = static_cast<Move>(*word);
}

const std::vector<Key<TourPlan>>& top_keys() {
  static const std::vector<Key<TourPlan>> keys{
      {"horizon",
       &TourPlan::horizon,
       {-kPlaces, kPlaces},
       "px",
       "row of the horizon, from above",
       "the middle row, or the vanishing point's"},
      {"vanishing",
       read_vanishing,
       {},
       "px",
       "[x, y]: where lines that lead straight away from the viewer meet",
       "the horizon's middle"},
      {"back",
       &TourPlan::back,
       {-kPlaces, kPlaces},
       "px",
       "row where the floor ends and a back wall stands, as wide and high as the picture; without it and a "
       "rectangle "
       "the floor goes on to the horizon, and all above is infinitely far",
       "none"},
      {"rectangle",
       read_rectangle,
       {},
       "px",
       "[left, top, right, bottom] of the back wall; where an edge lies inside the picture a side wall, or "
       "the ceiling, "
       "begins there",
       "none"},
      {"view",
       &TourPlan::view_deg,
       {1, 150},
       "degrees",
       "what the picture's own camera saw from the left to the right edge; wider: less depth"},
      {"relative",
       &TourPlan::relative,
       {},
       "",
       "true: the lengths above, and foot, are shares of the picture's width and height, not px"},
      {"move",
       read_move,
       {},
       "",
       "in, pan, truck, rise or orbit: a path without keys",
       "in, where there is no key"},
      {"amount",
       &TourPlan::amount,
       {-100, 100},
       "",
       "how far the move goes: 2 twice as far, -1 the other way"},
      {"seconds",
       &TourPlan::seconds,
       {0.01, 1e5},
       "s",
       "duration of the tour",
       "the last key's time, or the film's"},
      {"ease", &TourPlan::ease, {}, "", "the camera starts from rest and comes to rest"},
      {"beyond",
       Words<TourPlan>{{"narrow", "mirror"},
                       [](TourPlan& plan, std::size_t word) { plan.beyond = static_cast<Beyond>(word); }},
       {},
       "",
       "where the camera would see more than the picture shows: narrow the view of the whole tour until it "
       "does not, or "
       "show the planes mirrored there"}};
  return keys;
}

void read_position(Section& section, PathKey& key) {
  std::optional<std::array<double, 3>> position;
  read_numbers(section, "position", position, {-kPlaces, kPlaces});
  if (position) key.place.position = {(*position)[0], (*position)[1], (*position)[2]};
}
void read_look(Section& section, PathKey& key) {
  std::optional<std::array<double, 2>> look;
  read_numbers(section, "look", look, {-80, 80});
  if (look) key.place.yaw_deg = (*look)[0], key.place.pitch_deg = (*look)[1];
}
void read_view(Section& section, PathKey& key) { section.read("view", key.place.view_deg, {1, 150}); }

const std::vector<Key<PathKey>>& path_keys() {
  static const std::vector<Key<PathKey>> keys{
      {"time", &PathKey::time_s, {0, 1e5}, "s", "after the key before", kNeeded},
      {"position",
       read_position,
       {},
       "heights of the camera above the floor",
       "[right, up, ahead] of the picture's own camera",
       "the key before's"},
      {"look", read_look, {}, "degrees", "[right, up], -80 to 80", "the key before's"},
      {"view", read_view, {}, "degrees", "1 to 150, from the left to the right edge", "the key before's"}};
  return keys;
}

const std::vector<Key<TourThing>>& thing_keys() {
  static const std::vector<Key<TourThing>> keys{
      {"name", &TourThing::name, {}, "", "for messages", "its number"},
      {"matte",
       &TourThing::matte,
       {},
       "",
       "grey picture of the film's size, white where the thing is; of black and white alone its soft edge is "
       "found",
       kNeeded},
      {"foot",
       &TourThing::foot,
       {-kPlaces, kPlaces},
       "px",
       "row in which it stands on the floor",
       "the matte's lowest"},
      {"depth",
       &TourThing::depth,
       {1e-3, kPlaces},
       "heights of the camera",
       "how far away it stands, instead of foot",
       "from foot"},
      {"grow",
       &TourThing::grow_px,
       {0, 100},
       "px",
       "over which the matte softly ends, where bits of the thing's rim stay behind on the floor"}};
  return keys;
}

TourPlan read_file(Section& file, const std::filesystem::path& name) {
  TourPlan plan;
  plan.file = name;
  read_keys(file, top_keys(), plan, kExplained);
  std::vector<Section> keys = file.tables("key", kMaxKeys), things = file.tables("thing", kMaxThings);
  file.done();
  PathKey key{.time_s = 0, .place = {.view_deg = plan.view_deg}};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    read_keys(keys[i], path_keys(), key, kExplained);
    keys[i].done();
    if (i > 0 && !(key.time_s > plan.keys.back().time_s))
      keys[i].refuse("time", fmt::format("{} does not come after {}", key.time_s, plan.keys.back().time_s),
                     "Give times that grow from key to key");
    plan.keys.push_back(key);
  }
  if (plan.move && !keys.empty())
    file.refuse("move", "there are keys too, and one camera", "Take the move or the tables [[key]] out");
  if (plan.back && plan.rectangle)
    file.refuse("back", "the rectangle says already where the back wall stands", "Give one of the two");
  for (Section& section : things) {
    TourThing thing;
    read_keys(section, thing_keys(), thing, kExplained);
    section.done();
    if (thing.foot && thing.depth)
      section.refuse("depth", "foot says already how far away it is", "Give one of the two");
    if (thing.name.empty()) thing.name = fmt::format("thing {}", plan.things.size() + 1);
    plan.things.push_back(thing);
  }
  return plan;
}

std::string where_of(const TourPlan& plan) { return plan.file.empty() ? "synth tour" : plan.file.string(); }

}  // namespace

TourPlan parse_tour(std::string_view text, const std::filesystem::path& name) {
  const TomlText parsed(text, name, kRemedy);
  Section file = parsed.root();
  return read_file(file, name);
}

TourPlan read_tour(const std::filesystem::path& path) {
  return parse_tour(toml_file_text(path, kRemedy), path);
}

std::string tour_keys() {
  return "A tour is a TOML file. Files that it names lie beside it. px of the picture, (0, 0) its upper left "
         "corner; "
         "space in\nheights of the picture's own camera above the floor.\n\n" +
         key_lines(key_texts(top_keys())) + "\n[[key]]: the camera at a moment; smooth between them\n" +
         key_lines(key_texts(path_keys())) +
         "\n[[thing]]: stands upright on the floor and faces the viewer; behind it the picture is filled "
         "in\n" +
         key_lines(key_texts(thing_keys()));
}

void change(TourPlan& plan, const std::string& move, std::optional<double> amount,
            std::optional<double> horizon) {
  const auto refuse = [](const std::string& what, const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kUsage, what, fault, remedy);
  };
  if (!move.empty() && !plan.keys.empty())
    refuse("--move " + move, plan.file.string() + " has a path of keys",
           "Leave the move out, or take the tables [[key]] out of the file");
  if (amount && !plan.keys.empty())
    refuse("--amount", plan.file.string() + " has a path of keys, and no move",
           "Leave it out, or take the tables [[key]] out of the file");
  if (horizon && plan.relative)
    refuse("--horizon", plan.file.string() + " has relative = true, and this is in px",
           "Say the horizon in the file");
  if (!move.empty()) {
    const auto at = std::ranges::find(move_names(), move);
    if (at == move_names().end())
      refuse("move " + move, "there is no such move",
             fmt::format("Choose one of {}", fmt::join(move_names(), ", ")));
    plan.move = static_cast<Move>(at - move_names().begin());
  }
  if (amount && !(std::abs(*amount) <= 100))
    refuse("amount", fmt::format("{} is out of range", *amount), "Give -100 to 100");
  plan.amount = amount.value_or(plan.amount);
  if (horizon) plan.horizon = horizon;
}

Mesh mesh_of(const TourPlan& plan, cv::Size picture) {
  const double x = plan.relative ? picture.width : 1, y = plan.relative ? picture.height : 1;
  Mesh mesh{.picture = picture,
            .vanishing = {0.5 * picture.width, 0.5 * picture.height},
            .view_deg = plan.view_deg};
  if (plan.rectangle) {
    const auto& r = *plan.rectangle;
    mesh.left = x * r[0], mesh.top = y * r[1], mesh.right = x * r[2], mesh.bottom = y * r[3];
    mesh.vanishing = {0.5 * (mesh.left + mesh.right), 0.5 * (mesh.top + mesh.bottom)};
  } else {
    mesh.right = picture.width;
    mesh.bottom = y * plan.back.value_or(0);
    mesh.back = plan.back.has_value();
  }
  if (plan.vanishing) mesh.vanishing = {x * (*plan.vanishing)[0], y * (*plan.vanishing)[1]};
  if (plan.horizon) {
    if (plan.vanishing && std::abs(mesh.vanishing.y - y * *plan.horizon) > 1e-6 * picture.height)
      throw Error(ErrorKind::kInput, where_of(plan),
                  fmt::format("the vanishing point lies in row {:.6g}, and the horizon is {:.6g}",
                              mesh.vanishing.y, y * *plan.horizon),
                  "The vanishing point lies on the horizon: give one of the two");
    mesh.vanishing.y = y * *plan.horizon;
  }
  return mesh;
}

double depth_of(const TourThing& thing, const TourPlan& plan, const cv::Mat& matte, const Room& room) {
  if (thing.depth) return *thing.depth;
  const cv::Rect box = cv::boundingRect(matte >= 128);
  if (box.empty())
    throw Error(ErrorKind::kInput, thing.matte.string(), "nothing in it is as light as 128",
                "Paint white what stands upright");
  const double foot = thing.foot ? (plan.relative ? matte.rows : 1) * *thing.foot : box.br().y;
  const double depth = room.floor_depth(foot);
  if (!(depth < kPlaces))
    throw Error(ErrorKind::kInput, where_of(plan) + ": " + thing.name,
                fmt::format("its foot is in row {:.6g}, and the floor begins below the horizon", foot),
                "Give a foot further down, or a depth");
  return depth;
}

}  // namespace freshet::synth::tour
