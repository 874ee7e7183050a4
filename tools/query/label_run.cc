#include "tools/query/label_run.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "query/labelling/labelling_memo.h"
#include "query/labelling/shares.h"
#include "tools/console/progress.h"
#include "tools/options/cache_options.h"

namespace freshet::tools {

std::shared_ptr<const query::SearchBase> open_with_progress(const store::Snapshot& snapshot,
                                                            const SearchOptions& search, bool built_late) {
  search.check(snapshot);
  Progress progress;
  progress.show("reading the index", 0, 0);
  query::IndexChoice choice = search.index();
  choice.built_late = built_late;
  auto base = std::make_shared<const query::SearchBase>(query::open_search(snapshot, choice));
  progress.finish();
  return base;
}

query::LabelRequest request_of(const SearchOptions& search, const AskedMotion& asked,
                               const Duration& duration, const SolverOptions* labelling) {
  query::LabelRequest request{
      .piece_scale = search.piece_scale(), .duration_s = duration.seconds(), .guesses = asked.guesses};
  request.options.candidates = search.options();
  request.options.guide = asked.guide;
  request.options.hint_search = asked.search;
  request.options.guide_costs = query::default_guide_costs(asked.search);
  if (labelling != nullptr) {
    request.options.costs = labelling->costs();
    request.options.reuse = labelling->reuse();
    request.options.guide_costs = labelling->guide_costs(asked.search);
    request.options.minimizer = labelling->solver();
    request.options.max_iterations = labelling->iterations();
  }
  if (query::guide_overrules_direction(request))
    say("--direction has no effect: the strokes or the orientation map say where the fluid goes");
  return request;
}

query::PreparedLabelling prepare_with_progress(const store::Snapshot& snapshot, const query::SearchBase& base,
                                               const TargetFiles::Loaded& loaded,
                                               const query::LabelRequest& request, const RunContext& context,
                                               query::LabellingMemo* memo) {
  Progress progress;
  query::LabelRequest looking = request;
  looking.looked_at = loaded.looked_at();
  query::PreparedLabelling prepared = query::prepare(snapshot, base, loaded.picture, loaded.matte, looking,
                                                     progress.callback(), context.stop, memo);
  progress.finish();
  if (!prepared.kind.words.empty()) say(prepared.kind.words);
  if (!prepared.guess.empty())
    say(prepared.guess + "; --direction or --strokes where it goes, --hint none asks nothing");
  return prepared;
}

LabelRun label_with_progress(const store::Snapshot& snapshot, std::shared_ptr<const query::SearchBase> base,
                             const TargetFiles::Loaded& loaded, const query::LabelRequest& request,
                             const Duration& duration, const RunContext& context, cache::ResultCache* cache) {
  LabelRun run;
  run.base = std::move(base);
  std::optional<query::LabellingMemo> memo;
  if (cache != nullptr) memo.emplace(*cache, snapshot, *run.base);
  query::LabellingMemo* const known = memo ? &*memo : nullptr;
  const query::PreparedLabelling prepared =
      prepare_with_progress(snapshot, *run.base, loaded, request, context, known);
  run.kind = prepared.kind;
  Progress progress;
  run.labelling = query::label(snapshot, *run.base, loaded.picture, loaded.matte, prepared.options,
                               progress.callback(), context.stop, known);
  progress.finish();
  finish_cache(cache);
  say_filters(run.labelling.search.filtered, duration);
  for (const std::string& note : run.labelling.search.candidates.notes) say(note);
  if (memo) say(query::to_string(memo->reuse()));
  say_shares(run.labelling.assignment);
  return run;
}

nlohmann::json to_json(const query::KindChoice& kind) {
  return {{"class", kind.look.name()},
          {"share", kind.look.sureness()},
          {"sure", kind.look.sure()},
          {"only", kind.taken.empty() ? nlohmann::json() : nlohmann::json(kind.taken)}};
}

nlohmann::json to_json(const query::SearchBase& base, const query::LabelSeconds& seconds) {
  return {{"open", base.seconds},
          {"cut", seconds.cut},
          {"search", seconds.search},
          {"costs", seconds.costs},
          {"minimize", seconds.minimize}};
}

nlohmann::json to_json(const query::Filtered& filtered) {
  nlohmann::json steps = nlohmann::json::array();
  for (const query::FilterStep& step : filtered.steps)
    steps.push_back({{"what", step.what}, {"patches", step.patches}, {"clips", step.clips}});
  return {{"steps", steps}, {"too_short", filtered.too_short}};
}

nlohmann::json shares_json(const query::Assignment& assignment) {
  const query::LargestShares shares = query::largest_shares(assignment);
  const std::string warning = query::shares_warning(assignment, shares);
  return {{"largest_clip", shares.clip},
          {"largest_patch", shares.patch},
          {"clip", assignment.clips.empty() ? "" : assignment.clips[shares.most_used].name},
          {"warning", warning.empty() ? nlohmann::json() : nlohmann::json(warning)}};
}

void say_shares(const query::Assignment& assignment) {
  const std::string warning = query::shares_warning(assignment, query::largest_shares(assignment));
  if (!warning.empty()) say(warning);
}

nlohmann::json label_json(const LabelRun& run) {
  const query::Assignment& assignment = run.labelling.assignment;
  nlohmann::json json{
      {"pieces", assignment.pieces.size()}, {"edges", run.labelling.search.target.edges.size()},
      {"solver", assignment.minimizer},     {"costs", assignment.cost_form},
      {"energy", assignment.energy},        {"iterations", run.labelling.iterations},
      {"shares", shares_json(assignment)},  {"filters", to_json(run.labelling.search.filtered)},
      {"looks_like", to_json(run.kind)},    {"seconds", to_json(*run.base, run.labelling.seconds)}};
  if (std::isfinite(assignment.lower_bound)) {
    json["lower_bound"] = assignment.lower_bound;
    json["gap"] = assignment.gap();
  }
  json["gap_aimed"] = query::kGapAimed;
  json["gap_reached"] = assignment.reaches_gap();
  return json;
}

std::string gap_text(const query::Assignment& assignment) {
  const double aimed = 100 * query::kGapAimed, gap = 100 * assignment.gap();
  if (!std::isfinite(gap)) return fmt::format("no bound, so that a gap of at most {}% is not known", aimed);
  return assignment.reaches_gap() ? fmt::format("gap {:.2f}%, at most {}% as it should be", gap, aimed)
                                  : fmt::format("gap {:.2f}%, more than the {}% aimed at", gap, aimed);
}

std::string label_summary(const LabelRun& run) {
  const query::Assignment& a = run.labelling.assignment;
  const query::LabelSeconds& s = run.labelling.seconds;
  const double open = run.base->seconds;
  std::string text = fmt::format("{} pieces from {} clips, {}, energy {:.4f}", a.pieces.size(),
                                 a.clips.size(), a.minimizer, a.energy);
  if (std::isfinite(a.lower_bound)) text += fmt::format(", bound {:.4f}", a.lower_bound);
  text += ", " + gap_text(a) + ", " + query::to_string(query::largest_shares(a));
  return text +
         fmt::format(", {:.1f} s (index {:.1f}, pieces {:.1f}, search {:.1f}, costs {:.1f}, solver {:.1f})",
                     open + s.cut + s.search + s.costs + s.minimize, open, s.cut, s.search, s.costs,
                     s.minimize);
}

}  // namespace freshet::tools
