#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "studio/drawing/toml_text.h"
#include "studio/ways/way.h"

namespace freshet::studio {
namespace {

/// Of a pin. What is drawn has its origin in a pixel's corner, the file in its middle.
std::string place_toml(cv::Point2f drawn) {
  return fmt::format("[{:.2f}, {:.2f}]", std::max(0.f, drawn.x - .5f), std::max(0.f, drawn.y - .5f));
}

/// What was said of paths and pins, as `freshet synth stills --keys` explains it.
std::string edits_toml(const Stills& stills) {
  std::map<std::string, std::pair<std::vector<std::string>, std::vector<std::string>>> of_region;
  for (const StillsPath& path : stills.paths) {
    auto& [refused, turned] = of_region[path.region];
    (path.refused ? refused : turned).push_back(toml_list(path.names));
  }
  std::string toml = fmt::format("speed = {}\nsplit = {}\n", stills.speed, stills.split);
  for (const auto& [region, paths] : of_region)
    toml += fmt::format("[[region]]\nname = {}\nrefuse = [{}]\nturn = [{}]\n", toml_text(region),
                        fmt::join(paths.first, ", "), fmt::join(paths.second, ", "));
  for (const StillsPin& pin : stills.pins)
    toml += fmt::format("[[pin]]\nfrom = {}\nto = {}\nat = {}\ngoes = {}\nreach = {}\n", toml_text(pin.from),
                        toml_text(pin.to), place_toml(pin.at), place_toml(pin.goes), pin.reach);
  return toml;
}

/// A moving scene from the stills that lie in the way's folder.
WayPlan plan_stills(const Document& document) {
  const Stills& stills = document.stills;
  WayPlan plan{.folder = "stills",
               .commands = {{"synth", "stills", "ways/stills/pictures", "--edits", "ways/stills/edits.toml",
                             "--seconds", fmt::format("{}", stills.seconds), "-o", "ways/stills/film.mp4",
                             "--sheet", "ways/stills/regions.png", "--page", "ways/stills/page.html",
                             "--cache", "ways/stills/kept", "--json", "--overwrite"}},
               .film = "ways/stills/film.mp4",
               .answer = "found.json",
               .shown = {"regions.png", "page.html"}};
  if (stills.loop) plan.commands[0].emplace_back("--loop");
  if (!stills.full) plan.commands[0].emplace_back("--preview");
  return plan;
}

std::vector<WayFile> stills_files(const WayInput& input) {
  return {{"edits.toml", edits_toml(input.document.stills)}};
}

}  // namespace

extern const Way kStillsWay{.name = "stills", .plan = plan_stills, .files = stills_files};

}  // namespace freshet::studio
