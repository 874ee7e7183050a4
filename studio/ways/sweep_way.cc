#include <fmt/format.h>

#include "studio/ways/sweep_recipe.h"
#include "studio/ways/way.h"

namespace freshet::studio {
namespace {

/// The animation under several settings, whose films lie beside each other.
WayPlan plan_sweep(const Document& document) {
  const std::vector<std::string> varied = sweep_words(document);
  WayPlan plan{.folder = "sweep",
               .commands = {{"synth", "sweep", "--config", "ways/sweep/sweep.toml"}},
               .film = "",
               .answer = "made.json",
               .shown = {"sheet.png"},
               .store = document.store,
               .animates = true};
  std::vector<std::string>& words = plan.commands[0];
  words.insert(words.end(), varied.begin(), varied.end());
  words.insert(words.end(), {"-o", "ways/sweep", "--json", "--overwrite"});
  for (std::size_t i = 1; i <= swept(document.sweep); ++i) plan.shown.push_back(fmt::format("{:02}.mp4", i));
  return plan;
}

std::vector<WayFile> sweep_files(const WayInput& input) {
  return {{"sweep.toml", sweep_toml(input.document, input.files)}};
}

}  // namespace

extern const Way kSweepWay{.name = "sweep", .plan = plan_sweep, .files = sweep_files};

}  // namespace freshet::studio
