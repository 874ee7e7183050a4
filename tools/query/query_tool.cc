#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "query/labelling/contact_sheet.h"
#include "query/labelling/label_map.h"
#include "query/labelling/labelling.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/placement/assigned.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/console/table.h"
#include "tools/options/cache_options.h"
#include "tools/options/duration.h"
#include "tools/options/hold_options.h"
#include "tools/options/motion_options.h"
#include "tools/options/search_options.h"
#include "tools/options/solver_options.h"
#include "tools/options/target_files.h"
#include "tools/query/label_run.h"
#include "vision/look/fluid_kind.h"

namespace freshet::tools {
namespace {

/// What is looked for, and for which picture.
struct Question {
  TargetFiles target;
  HoldOptions hold;
  SearchOptions search;
  MotionOptions motion;
  Duration duration;

  void add_to(CLI::App& app) {
    target.add_to(app);
    hold.add_to(app);
    search.add_to(app);
    motion.add_to(app);
    duration.add_to(app);
  }
  TargetFiles::Loaded load() const {
    TargetFiles::Loaded loaded = target.load();
    hold.take_out(loaded);
    say_reduction(target, loaded);
    return loaded;
  }
};

struct CandidatesCommand {
  Question question;
  std::string sheet;
  bool json = false;
};

struct LabelCommand {
  Question question;
  SolverOptions labelling;
  CacheOptions cache;
  std::string assignment, map, sheet;
  bool json = false;
};

struct KindCommand {
  TargetFiles target;
  bool json = false;
};

void print_candidates(const store::Snapshot& snapshot, const query::CandidateSearch& search) {
  // Per clip: of how many pieces it is among the candidates, the best, and how well.
  struct Count {
    std::size_t among = 0, best = 0;
    double score = 0;
  };
  std::map<std::uint32_t, Count> clips;
  for (std::size_t piece = 0; piece < search.candidates.pieces(); ++piece) {
    const auto rows = search.candidates.rows_of(piece);
    const auto scores = search.candidates.scores_of(piece);
    std::map<std::uint32_t, bool> seen;
    for (stored::Row row : rows)
      if (!std::exchange(seen[search.table().clip[row]], true)) ++clips[search.table().clip[row]].among;
    Count& best = clips[search.table().clip[rows[0]]];
    ++best.best;
    best.score += scores[0];
  }
  std::vector<std::pair<std::uint32_t, Count>> order(clips.begin(), clips.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second.best > b.second.best; });
  const bool several = snapshot.files().size() > 1;
  std::vector<std::string> head{"clip", "class", "best of pieces", "mean score", "among candidates of"};
  if (several) head.push_back("store");
  Table table(head);
  for (const auto& [clip, count] : order) {
    const store::ClipId id = search.table().clips[clip];
    const store::ClipRecord& record = snapshot.clip(id);
    std::vector<std::string> row{
        record.name, record.class_name, fmt::format("{}", count.best),
        count.best ? fmt::format("{:.2f}", count.score / static_cast<double>(count.best)) : "-",
        fmt::format("{}", count.among)};
    if (several) row.push_back(snapshot.file_of(id).string());
    table.row(row);
  }
  fmt::print("{}", table.text());
}

nlohmann::json candidates_json(const store::Snapshot& snapshot, const query::CandidateSearch& search,
                               const std::vector<vision::Variant>& variants) {
  const bool several = snapshot.files().size() > 1;
  nlohmann::json pieces = nlohmann::json::array();
  for (std::size_t piece = 0; piece < search.candidates.pieces(); ++piece) {
    nlohmann::json found = nlohmann::json::array();
    const auto rows = search.candidates.rows_of(piece);
    const auto scores = search.candidates.scores_of(piece);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const stored::Row row = rows[i];
      const store::ClipId clip = search.table().clips[search.table().clip[row]];
      const vision::Variant& variant = variants[search.table().variant[row]];
      found.push_back({{"row", row},
                       {"clip", snapshot.clip(clip).name},
                       {"scale", variant.scale},
                       {"rotation", variant.rotation_deg},
                       {"flip", variant.flip},
                       {"x", search.table().x[row]},
                       {"y", search.table().y[row]},
                       {"score", scores[i]}});
      if (several) found.back()["store"] = snapshot.file_of(clip).string();
    }
    pieces.push_back({{"x", search.target.corners[piece].x},
                      {"y", search.target.corners[piece].y},
                      {"candidates", found}});
  }
  return pieces;
}

void run_candidates(CandidatesCommand& command, const RunContext& context) {
  check_picture_output(command.sheet);
  command.question.motion.check_outputs();
  const store::Snapshot snapshot = command.question.target.open_store(context);
  TargetFiles::Loaded loaded = command.question.load();
  AskedMotion asked = command.question.motion.read(loaded, command.question.search);
  const query::LabelRequest request = request_of(command.question.search, asked, command.question.duration);
  const bool guesses = query::may_guess(request);
  asked.guide = query::guide_of_animation(request, loaded.picture.size());
  if (!guesses) command.question.motion.draw(loaded, asked, {});
  const auto base = open_with_progress(snapshot, command.question.search);
  const query::PreparedLabelling prepared = prepare_with_progress(snapshot, *base, loaded, request, context);
  if (guesses) {
    asked.guide = prepared.options.guide;
    command.question.motion.draw(loaded, asked, {});
  }
  Progress progress;
  const query::CandidateSearch search = query::search_candidates(
      snapshot, *base, loaded.picture, loaded.matte, prepared.options, progress.callback(), context.stop);
  progress.finish();
  say_filters(search.filtered, command.question.duration);
  for (const std::string& note : search.candidates.notes) say(note);
  const std::size_t pieces = search.candidates.pieces();
  const std::size_t total = search.filtered.rows.count();
  say(fmt::format("{} pieces searched among {} patches in {:.2f} s ({:.2f} ms per piece)", pieces, total,
                  search.seconds.search, 1e3 * search.seconds.search / static_cast<double>(pieces)));
  if (!command.sheet.empty())
    media::write_picture(command.sheet, query::contact_sheet(snapshot, loaded.picture, search));
  if (command.json) {
    fmt::print("{}\n",
               nlohmann::json{{"filters", to_json(search.filtered)},
                              {"looks_like", to_json(prepared.kind)},
                              {"seconds", to_json(*base, search.seconds)},
                              {"pieces", candidates_json(snapshot, search, base->settings.variants())}}
                   .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    print_candidates(snapshot, search);
  }
  if (command.json) return;
  for (const std::string& path : command.question.motion.outputs())
    if (!path.empty()) fmt::print("{}\n", path);
  if (!command.sheet.empty()) fmt::print("{}\n", command.sheet);
}

void run_label(LabelCommand& command, const RunContext& context) {
  check_output_folder(command.assignment);
  check_picture_output(command.map);
  check_picture_output(command.sheet);
  command.question.motion.check_outputs();
  const store::Snapshot snapshot = command.question.target.open_store(context);
  TargetFiles::Loaded loaded = command.question.load();
  AskedMotion asked = command.question.motion.read(loaded, command.question.search);
  const query::LabelRequest request =
      request_of(command.question.search, asked, command.question.duration, &command.labelling);
  const auto cache = command.cache.open();
  const LabelRun run =
      label_with_progress(snapshot, open_with_progress(snapshot, command.question.search, cache != nullptr),
                          loaded, request, command.question.duration, context, cache.get());
  asked.guide = query::guide_of_animation(request, loaded.picture.size());
  const query::Labelling& labelling = run.labelling;
  const query::Assignment& assignment = labelling.assignment;
  if (!command.assignment.empty()) query::write_assignment(command.assignment, assignment);
  const cv::Mat motion =
      command.question.motion.needs_motion(asked)
          ? synth::animate::motion_field(snapshot, run.base->settings,
                                         synth::animate::placement_from(assignment, snapshot),
                                         loaded.picture.size())
          : cv::Mat();
  command.question.motion.draw(loaded, asked, motion);
  command.question.motion.write_maps(loaded, motion);
  if (!command.map.empty())
    media::write_picture(command.map, query::label_map(loaded.picture, &loaded.matte, assignment));
  if (!command.sheet.empty())
    media::write_picture(command.sheet,
                         query::contact_sheet(snapshot, loaded.picture, labelling.search, &labelling.labels));
  if (command.json) {
    nlohmann::json json = label_json(run);
    json["assignment"] = nlohmann::json::parse(query::to_json(assignment));
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  std::map<std::uint32_t, std::size_t> pieces_of;
  for (const query::AssignedPiece& piece : assignment.pieces) ++pieces_of[piece.clip];
  std::vector<std::pair<std::uint32_t, std::size_t>> order(pieces_of.begin(), pieces_of.end());
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  Table table({"clip", "class", "pieces", "share", "licence"});
  for (const auto& [clip, count] : order)
    table.row({assignment.clips[clip].name, assignment.clips[clip].class_name, fmt::format("{}", count),
               fmt::format("{:.0f}%", 100.0 * static_cast<double>(count) /
                                          static_cast<double>(assignment.pieces.size())),
               assignment.clips[clip].licence});
  fmt::print("{}\n{}\n", table.text(), label_summary(run));
  std::vector<std::string> paths = command.question.motion.outputs();
  paths.insert(paths.end(), {command.assignment, command.map, command.sheet});
  for (const std::string& path : paths)
    if (!path.empty()) fmt::print("{}\n", path);
}

/// Needs no store: what is known of the kinds' looks comes with the program.
void run_kind(const KindCommand& command) {
  const TargetFiles::Loaded loaded = command.target.load();
  const auto look = vision::fluid_look(loaded.picture, loaded.matte);
  const vision::FluidKind kind = vision::fluid_kind(look);
  if (command.json) {
    nlohmann::json shares, readings;
    for (std::size_t i = 0; i < kind.share.size(); ++i) shares[vision::kFluidKinds[i]] = kind.share[i];
    for (std::size_t i = 0; i < look.size(); ++i) readings[std::string(vision::kLookFigures[i])] = look[i];
    const nlohmann::json json{
        {"class", kind.name()}, {"sure", kind.sure()}, {"shares", shares}, {"readings", readings}};
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    return;
  }
  Table table({"class", "share"});
  for (std::size_t i = 0; i < kind.share.size(); ++i)
    table.row({vision::kFluidKinds[i], fmt::format("{:.2f}", kind.share[i])});
  fmt::print("{}", table.text());
  if (!kind.sure()) say(fmt::format("unsure: it may be {}. --class says what it is", kind.name()));
}

}  // namespace

void add_query(CLI::App& app, RunContext& context) {
  CLI::App* query =
      app.add_subcommand("query", "Search a store for the patches that could animate a picture");
  query->require_subcommand(1);

  auto candidates = std::make_shared<CandidatesCommand>();
  CLI::App* sub =
      query->add_subcommand("candidates", "The patches that look most like each piece of a picture");
  candidates->question.add_to(*sub);
  sub->add_option("--sheet", candidates->sheet,
                  "Write a contact sheet: pieces, and their best candidates (PNG, JPEG)");
  sub->add_flag("--json", candidates->json, "Print all candidates as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([candidates, &context] { run_candidates(*candidates, context); });

  auto label = std::make_shared<LabelCommand>();
  sub = query->add_subcommand("label", "Choose one patch for each piece, so that neighbours go together");
  label->question.add_to(*sub);
  label->question.motion.add_outputs_to(*sub);
  label->labelling.add_to(*sub);
  label->cache.add_to(*sub);
  sub->add_option("-o,--output", label->assignment,
                  "Write the assignment, for freshet synth animate --assignment (JSON)");
  sub->add_option("--map", label->map, "Write a map of the picture coloured by clip (PNG, JPEG)");
  sub->add_option("--sheet", label->sheet,
                  "Write a contact sheet that shows the chosen candidates (PNG, JPEG)");
  sub->add_flag("--json", label->json, "Print the result as JSON");
  add_overwrite(*sub);
  add_threads(*sub);
  sub->callback([label, &context] { run_label(*label, context); });

  auto kind = std::make_shared<KindCommand>();
  sub =
      query->add_subcommand("kind", "Water, fire, smoke or clouds: the class of fluid that a picture shows");
  sub->add_option("PICTURE", kind->target.picture, "The still picture (PNG, JPEG, TIFF, ...)")->required();
  CLI::Option* const matte = sub->add_option(
      "--matte", kind->target.matte, "Grey picture, white where the fluid is [the picture's own alpha]");
  sub->add_flag("--whole", kind->target.whole, kWholeHelp)->excludes(matte);
  sub->add_flag("--json", kind->json,
                "Print class, whether it is sure (a share of .85), shares and readings as JSON");
  sub->callback([kind] { run_kind(*kind); });

  add_bench(*query, context);
}

}  // namespace freshet::tools
