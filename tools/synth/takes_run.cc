#include "tools/synth/takes_run.h"

#include <fmt/format.h>

#include "stored/store_settings.h"
#include "tools/console/progress.h"

namespace freshet::tools {

namespace takes = synth::takes;

takes::Open open_of(const CLI::App& given) {
  const auto open = [&](const char* name) { return given.count(name) == 0; };
  return {.speed = open("--speed") && open("--retiming-map"),
          .layout = open("--layout"),
          .life = open("--detail-life"),
          .method = open("--method")};
}

std::optional<takes::Trial> choose_take(const store::Snapshot& snapshot, AnimateInputs& inputs,
                                        const query::Assignment& assignment, const std::string& kind,
                                        int count, const takes::Open& open, const RunContext& context) {
  std::vector<takes::Take> planned = takes::plan_takes(kind, inputs.options, inputs.asked.guide, open, count);
  for (takes::Take& take : planned)
    if (take.speed != 1 && inputs.asked.guide.speed.empty())
      take.options = fmt::format("--speed {:.3g}", inputs.playing.factor * take.speed);
  const bool judged = inputs.options.frames >= synth::judging::kFewestFrames &&
                      cv::countNonZero(inputs.loaded.matte > 127) > 0;
  if (planned.size() < 2 || !judged) {
    say("--takes: there is but one take to try");
    return std::nullopt;
  }
  Progress progress;
  const auto told = [&, of = planned.size()](std::size_t done) {
    if (const auto callback = progress.callback()) callback({"takes", done, of});
  };
  takes::Trial trial = takes::try_takes({.snapshot = snapshot,
                                         .settings = stored::settings_of(snapshot),
                                         .picture = inputs.loaded.picture,
                                         .matte = inputs.loaded.matte,
                                         .assignment = assignment,
                                         .asked = inputs.asked.guide,
                                         .playing = inputs.playing,
                                         .options = inputs.options,
                                         .kind = kind},
                                        planned, {}, told, context.stop);
  progress.finish();
  const takes::JudgedTake &best = trial.takes[trial.best], &asked = trial.takes.front();
  say(fmt::format(
      "{} takes tried in {:.1f} s: {} ({:.1f} faults; as asked {:.1f}{}). --takes 1 makes it as asked",
      trial.takes.size(), trial.seconds, best.take.name, best.verdict.faults, asked.verdict.faults,
      trial.best == 0 ? "" : ", where " + takes::why(trial, 0)));
  takes::apply(best.take, trial.half_life_s, inputs.options, inputs.asked.guide, inputs.playing);
  return trial;
}

nlohmann::json takes_json(const std::optional<takes::Trial>& trial) {
  if (!trial) return nullptr;
  nlohmann::json list = nlohmann::json::array();
  for (std::size_t i = 0; i < trial->takes.size(); ++i) {
    const takes::JudgedTake& take = trial->takes[i];
    list.push_back({{"name", take.take.name},
                    {"options", take.take.options},
                    {"why", takes::why(*trial, i)},
                    {"chosen", i == trial->best}});
    if (take.failed.empty()) list.back()["faults"] = take.verdict.faults;
  }
  return {{"seconds", trial->seconds}, {"takes", list}};
}

}  // namespace freshet::tools
