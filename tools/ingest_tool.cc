#include <filesystem>
#include <iterator>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "ingest/growing_store.h"
#include "ingest/ingest.h"
#include "platform/printable.h"
#include "query/index/index_builder.h"
#include "tools/commands.h"
#include "tools/console/index_progress.h"
#include "tools/console/progress.h"
#include "tools/console/table.h"
#include "tools/options/settings_options.h"
#include "tools/options/shard_option.h"

namespace freshet::tools {
namespace {

struct IngestCommand {
  std::string store;
  std::vector<std::filesystem::path> paths;
  ShardOption shard;
  ingest::IngestOptions options;
  SettingsOptions settings;
  bool no_index = false, no_flann = false, json = false;
};

nlohmann::json to_json(const ingest::Span& span) {
  return {
      {"from_s", span.from_s}, {"to_s", span.to_s}, {"first_frame", span.first}, {"frames", span.frames()}};
}

nlohmann::json to_json(const ingest::ClipReport& clip) {
  const ingest::Screening& s = clip.screening;
  return {{"name", clip.name},
          {"part", clip.part ? to_json(*clip.part) : nlohmann::json()},
          {"class", clip.class_name},
          {"outcome", ingest::to_string(clip.outcome)},
          {"reasons", clip.reasons},
          {"notes", clip.notes},
          {"frames", clip.frames},
          {"width", clip.width},
          {"height", clip.height},
          {"fps", clip.fps},
          {"patches", clip.patches},
          {"stored_bytes", clip.stored_bytes},
          {"screening",
           {{"drift", s.camera.drift},
            {"shake", s.camera.shake},
            {"cuts", s.cuts},
            {"duplicated_share", s.duplicated_fraction},
            {"static_share", s.static_fraction},
            {"steady_rate", s.timing.steady},
            {"slowest_fps", s.timing.slowest_fps},
            {"fastest_fps", s.timing.fastest_fps},
            {"longest_gap_s", s.timing.longest_gap_s},
            {"truncated", s.truncated}}},
          {"seconds",
           {{"hash", clip.seconds.hash},
            {"survey", clip.seconds.survey},
            {"decode", clip.seconds.decode},
            {"screen", clip.seconds.screen},
            {"flow", clip.seconds.flow},
            {"motion", clip.seconds.motion},
            {"texture", clip.seconds.texture},
            {"life", clip.seconds.life},
            {"store", clip.seconds.store},
            {"patches", clip.seconds.patches},
            {"commit", clip.seconds.commit},
            {"total", clip.seconds.total}}}};
}

void print_report(const ingest::IngestReport& report) {
  Table table({"clip", "class", "frames", "size", "fps", "patches", "static", "drift", "shake", "s", "stored",
               "outcome", "why"});
  for (const ingest::ClipReport& clip : report.clips) {
    const bool opened = clip.outcome == ingest::Outcome::kAdded || clip.outcome == ingest::Outcome::kRefused;
    const bool measured = clip.screening.frames > 0;
    const auto known = [&](const std::string& text) { return opened ? text : std::string("-"); };
    const auto shown = [&](const std::string& text) { return measured ? text : std::string("-"); };
    table.row({clip.name, clip.class_name, fmt::format("{}", clip.frames),
               known(fmt::format("{}x{}", clip.width, clip.height)), known(fmt::format("{:.2f}", clip.fps)),
               fmt::format("{}", clip.patches), shown(fmt::format("{:.2f}", clip.screening.static_fraction)),
               shown(fmt::format("{:.1f}%", 100 * clip.screening.camera.drift)),
               shown(fmt::format("{:.2f}%", 100 * clip.screening.camera.shake)),
               fmt::format("{:.1f}", clip.seconds.total),
               shown(bytes_text(static_cast<double>(clip.stored_bytes))), ingest::to_string(clip.outcome),
               printable(fmt::format("{}", fmt::join(clip.reasons, "; ")))});
  }
  fmt::print("{}", table.text());
  fmt::print("{} added, {} already there, {} refused, {} failed\n", report.count(ingest::Outcome::kAdded),
             report.count(ingest::Outcome::kAlreadyThere), report.count(ingest::Outcome::kRefused),
             report.count(ingest::Outcome::kFailed));
}

/// What was found against a clip, as soon as it is found. That a clip is there already, the report says.
void say_reasons(const ingest::ClipReport& clip) {
  if (clip.outcome == ingest::Outcome::kAlreadyThere) return;
  for (const std::string& reason : clip.reasons)
    say(fmt::format("{} {}: {}", clip.name, ingest::to_string(clip.outcome), reason));
  for (const std::string& note : clip.notes) say(fmt::format("{}: {}", clip.name, note));
}

void run(const IngestCommand& command, RunContext& context) {
  ingest::IngestOptions options = command.options;
  options.shard = command.shard.read();
  ingest::GrowingStore growing(command.store, command.paths, options.shard,
                               [&] { return command.settings.for_new_store(); });
  if (!growing.is_new()) command.settings.check_against(growing.settings(), command.store);

  Progress progress;
  const ingest::IngestReport report = ingest::ingest(
      growing.store(), growing.settings(), command.paths, options,
      [&](const ingest::IngestProgress& at) {
        const std::string stage = fmt::format("[{}/{}] {}{}", at.clip + 1, at.clips,
                                              at.surveying ? "first look at " : "", at.source->name);
        progress.show(stage, at.frames, at.claimed_frames, "frames");
        if (at.finished) say_reasons(*at.finished);
      },
      context.stop);
  progress.finish();

  if (command.json) {
    nlohmann::json json{{"store", command.store}, {"clips", nlohmann::json::array()}};
    for (const ingest::ClipReport& clip : report.clips) json["clips"].push_back(to_json(clip));
    if (report.stopped) json["stopped"] = report.stopped->what();
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else if (!report.clips.empty()) {
    print_report(report);
  }
  const bool empty = growing.remove_if_empty();
  if (report.stopped) throw *report.stopped;
  if (empty) {
    throw Error(ErrorKind::kInput, command.store, "no clip was taken, for the reasons above",
                growing.is_new() ? "The store was not made" : "");
  }
  if (!command.no_index) {
    query::IndexOptions index;
    if (command.no_flann) index.flann.clear();
    update_index(growing.store(), index, context);
  }
  if (report.count(ingest::Outcome::kFailed) + report.count(ingest::Outcome::kRefused) > 0 &&
      report.count(ingest::Outcome::kAdded) + report.count(ingest::Outcome::kAlreadyThere) == 0)
    context.exit_code = 1;
}

}  // namespace

void add_ingest(CLI::App& app, RunContext& context) {
  auto command = std::make_shared<IngestCommand>();
  CLI::App* sub = app.add_subcommand(
      "ingest",
      "Add clips of fluid to a store, and create it if it does not exist. Clips that the store has are "
      "skipped, so an interrupted run can be repeated. Long films are cut into takes, and of a take in which "
      "the "
      "camera moves the stretches are taken where it stands: clips named FILM@START-END, in seconds. What is "
      "unfit is named and left out.");
  sub->add_option("STORE", command->store, "The store file")->required();
  sub->add_option("CLIP", command->paths, "Videos, or folders of videos (searched to any depth)")->required();
  sub->add_option("--class", command->options.class_name, "Class of all given clips [each clip's folder]");
  sub->add_option("--licence", command->options.licence,
                  "Licence of all given clips; recorded with every use of them");
  sub->add_flag("--force", command->options.force,
                "Take each clip whole, also where screening refuses it (moving camera, cuts, too short); the "
                "findings are "
                "still reported");
  sub->add_flag("--deinterlace", command->options.repairs.deinterlace,
                "Deinterlace. The stored frames then differ from the source's");
  sub->add_flag("--deblock", command->options.repairs.deblock,
                "Smooth 8 x 8 block borders of coarsely compressed clips. The stored frames then differ from "
                "the source's");
  command->shard.add_to(
      *sub, "Ingest only part I of N of the list, for stores that are built separately and merged [all]");
  CLI::Option* no_index =
      sub->add_flag("--no-index", command->no_index, "Do not update the index at the end");
  sub->add_flag("--no-flann", command->no_flann,
                "Leave FLANN's index out of the store. Searches with --index flann-hierarchical alone use it")
      ->excludes(no_index);
  sub->add_flag("--json", command->json, "Print the report as JSON");
  add_threads(*sub);
  command->settings.add_to(*sub);
  sub->callback([command, &context] { run(*command, context); });
}

}  // namespace freshet::tools
