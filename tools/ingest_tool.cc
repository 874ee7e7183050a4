#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include <unistd.h>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "ingest/growing_store.h"
#include "ingest/ingest.h"
#include "ingest/sealed_part.h"
#include "ingest/source_list.h"
#include "platform/printable.h"
#include "platform/whole_file.h"
#include "query/index/index_builder.h"
#include "store/new_file.h"
#include "store/rewrite/rewrite.h"
#include "store/store_list.h"
#include "stored/store_settings.h"
#include "synth/toml/section.h"
#include "tools/commands.h"
#include "tools/console/index_progress.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/console/table.h"
#include "tools/console/unfinished_folder.h"
#include "tools/ingest_page.h"
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
  std::filesystem::path page, sources;
  bool no_index = false, no_flann = false, json = false, dry_run = false, seal = false, gather = false;
};

nlohmann::json to_json(const ingest::Span& span) {
  return {
      {"from_s", span.from_s}, {"to_s", span.to_s}, {"first_frame", span.first}, {"frames", span.frames()}};
}

nlohmann::json to_json(const ingest::ClipReport& clip) {
  const ingest::Screening& s = clip.screening;
  return {{"name", clip.name},
          {"part", clip.part ? to_json(*clip.part) : nlohmann::json()},
          {"steadied_kept", clip.steadied_kept > 0 ? nlohmann::json(clip.steadied_kept) : nlohmann::json()},
          {"class", clip.class_name},
          {"outcome", ingest::to_string(clip.outcome)},
          {"reasons", clip.reasons},
          {"notes", clip.notes},
          {"help", clip.help},
          {"alike", clip.alike ? nlohmann::json{{"clip", clip.alike->name}, {"seconds", clip.alike->seconds}}
                               : nlohmann::json()},
          {"kind", clip.look.kind ? nlohmann::json(clip.look.kind->name()) : nlohmann::json()},
          {"kind_sure", clip.look.kind && clip.look.kind->sure()},
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
            {"crossed_share", s.crossed_fraction},
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
  const bool preview = report.count(ingest::Outcome::kWouldAdd) > 0;
  fmt::print("{} {}, {} already there, {} refused, {} failed\n",
             report.count(preview ? ingest::Outcome::kWouldAdd : ingest::Outcome::kAdded),
             preview ? "would be added" : "added", report.count(ingest::Outcome::kAlreadyThere),
             report.count(ingest::Outcome::kRefused), report.count(ingest::Outcome::kFailed));
  fmt::print("{}\n", taken_text(report));
}

/// What was found against a clip, as soon as it is found. That a clip is there already, the report says.
void say_reasons(const ingest::ClipReport& clip) {
  if (clip.outcome == ingest::Outcome::kAlreadyThere) return;
  for (const std::string& reason : clip.reasons)
    say(fmt::format("{} {}: {}", clip.name, ingest::to_string(clip.outcome), reason));
  for (const std::string& help : clip.help) say(fmt::format("{}: {}", clip.name, help));
  for (const std::string& note : clip.notes) say(fmt::format("{}: {}", clip.name, note));
}

nlohmann::json to_json(const std::string& store, const ingest::IngestReport& report) {
  nlohmann::json json{{"store", store}, {"clips", nlohmann::json::array()}};
  for (const ingest::ClipReport& clip : report.clips) json["clips"].push_back(to_json(clip));
  if (report.stopped) json["stopped"] = report.stopped->what();
  return json;
}

void print_json(const nlohmann::json& json) {
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
}

void show(const IngestCommand& command, const ingest::IngestReport& report) {
  if (!command.page.empty()) write_whole_file(command.page, ingest_page(command.store, report));
  if (command.json) {
    print_json(to_json(command.store, report));
  } else if (!report.clips.empty()) {
    print_report(report);
  }
}

void set_exit_code(const ingest::IngestReport& report, RunContext& context) {
  const auto count = [&](ingest::Outcome outcome) { return report.count(outcome); };
  if (count(ingest::Outcome::kFailed) + count(ingest::Outcome::kRefused) > 0 &&
      count(ingest::Outcome::kAdded) + count(ingest::Outcome::kWouldAdd) +
              count(ingest::Outcome::kAlreadyThere) ==
          0)
    context.exit_code = 1;
}

auto shown_on(Progress& progress) {
  return [&progress](const ingest::IngestProgress& at) {
    const std::string stage = fmt::format("[{}/{}] {}{}", at.clip + 1, at.clips,
                                          at.surveying ? "first look at " : "", at.source->name);
    progress.show(stage, at.frames, at.claimed_frames, "frames");
    if (at.finished) say_reasons(*at.finished);
  };
}

/// Throws for a new store what making it would.
void expect_can_be_made(const std::string& store) {
  store::expect_store_name(store);
  if (access(std::filesystem::absolute(store).parent_path().c_str(), W_OK | X_OK) == 0) return;
  throw Error(ErrorKind::kIo, store, fmt::format("cannot be created ({})", std::strerror(errno)),
              "Make its folder, and check that it can be written");
}

void run_dry(const IngestCommand& command, const ingest::IngestOptions& options, RunContext& context) {
  store::expect_one_store(command.store);
  std::optional<store::Store> store;
  vision::Settings settings;
  if (std::filesystem::exists(command.store)) {
    store = store::Store::open_read(command.store);
    settings = stored::settings_of(store->snapshot());
    command.settings.check_against(settings, command.store);
  } else {
    expect_can_be_made(command.store);
    settings = command.settings.for_new_store();
  }
  Progress progress;
  const ingest::IngestReport report = ingest::preview(store ? &*store : nullptr, settings, command.paths,
                                                      options, shown_on(progress), context.stop);
  progress.finish();
  show(command, report);
  if (report.stopped) throw *report.stopped;
  set_exit_code(report, context);
}

void update_index(const IngestCommand& command, store::Store& store, const RunContext& context) {
  if (command.no_index) return;
  query::IndexOptions index;
  if (command.no_flann) index.flann.clear();
  tools::update_index(store, index, context);
}

/// Rows [[clip]] of a TOML file.
std::vector<ingest::ClipSource> read_sources(const std::filesystem::path& file) {
  constexpr const char* kRemedy =
      "Give tables [[clip]] with a name, of a clip or a folder, and licence, author and source";
  constexpr std::size_t kMostRows = 100000;
  const synth::TomlText text(synth::toml_file_text(file, kRemedy), file, kRemedy);
  synth::Section root = text.root();
  std::vector<ingest::ClipSource> sources;
  for (synth::Section& row : root.tables("clip", kMostRows)) {
    ingest::ClipSource& said = sources.emplace_back();
    said.name = row.text("name").value_or("");
    if (said.name.empty()) row.refuse_whole("it has no name", kRemedy);
    said.licence = row.text("licence").value_or("");
    said.author = row.text("author").value_or("");
    said.source = row.text("source").value_or("");
    row.done();
  }
  root.done();
  if (sources.empty()) root.refuse_whole("it says nothing of any clip", kRemedy);
  return sources;
}

/// What decides what a part of a store holds.
nlohmann::json made_by(const IngestCommand& command) {
  nlohmann::json clips = nlohmann::json::array();
  for (const std::filesystem::path& path : command.paths) clips.push_back(path.string());
  const ingest::IngestOptions& options = command.options;
  nlohmann::json sources = nlohmann::json::array();
  for (const ingest::ClipSource& each : options.sources)
    sources.push_back({each.name, each.licence, each.author, each.source});
  return {{"clips", clips},
          {"class", options.class_name},
          {"licence", options.licence},
          {"sources", sources},
          {"force", options.force},
          {"steady", options.steady},
          {"deinterlace", options.repairs.deinterlace},
          {"deblock", options.repairs.deblock},
          {"sdr", options.repairs.sdr},
          {"list", ingest::list_hash(ingest::list_sources(command.paths))},
          {"settings", nlohmann::json::parse(vision::to_json(command.settings.for_new_store()))}};
}

/// A store that is there was gathered of parts, or is in the way.
bool is_gathered(const IngestCommand& command, const std::function<bool()>& is_sealed) {
  store::expect_one_store(command.store);
  store::expect_store_name(command.store);
  if (!std::filesystem::exists(command.store)) return false;
  if (is_sealed()) return true;
  throw Error(ErrorKind::kUsage, command.store, "is there already, and its parts are not",
              "Name another store, or add clips to it without --seal and --gather");
}

void run_sealed(const IngestCommand& command, const ingest::IngestOptions& options,
                const RunContext& context) {
  const nlohmann::json by = made_by(command);
  const ingest::SealedPart part(command.store, options.shard);
  const auto is_sealed = [&] { return part.is_sealed(by); };
  if (!is_gathered(command, is_sealed) && !is_sealed()) {
    const UnfinishedFolder local(std::filesystem::temp_directory_path(), "freshet-");
    const std::filesystem::path file = local.path() / "part.store";
    nlohmann::json report;
    {
      ingest::GrowingStore growing(file, command.paths, options.shard,
                                   [&] { return command.settings.for_new_store(); });
      Progress progress;
      const ingest::IngestReport made = ingest::ingest(growing.store(), growing.settings(), command.paths,
                                                       options, shown_on(progress), context.stop);
      progress.finish();
      if (made.stopped) throw *made.stopped;
      growing.remove_if_empty();
      report = to_json(part.store(), made);
    }
    part.seal(file, by, std::move(report));
  }
  if (command.json)
    print_json(part.report());
  else
    fmt::print("{}: {} clips\n", printable(part.store().string()),
               part.report()["stored"].get<std::size_t>());
}

/// All clips of all parts as one ingest would report them, in the order of the list of sources.
nlohmann::json gathered_report(const IngestCommand& command, const std::vector<ingest::SealedPart>& parts) {
  std::map<std::string, std::size_t> places;
  for (const ingest::Source& source : ingest::list_sources(command.paths))
    places.emplace(source.name, places.size());
  const auto place_of = [&](const std::string& name) {
    auto place = places.find(name);
    if (place == places.end()) place = places.find(name.substr(0, name.rfind('@')));  // a film's stretch
    return place == places.end() ? places.size() : place->second;
  };
  std::multimap<std::size_t, nlohmann::json> clips;
  for (const ingest::SealedPart& part : parts) {
    nlohmann::json report = part.report();
    for (nlohmann::json& clip : report["clips"])
      clips.emplace(place_of(clip["name"].get<std::string>()), std::move(clip));
  }
  nlohmann::json json{{"store", command.store}, {"clips", nlohmann::json::array()}};
  for (auto& [place, clip] : clips) json["clips"].push_back(std::move(clip));
  return json;
}

void run_gather(const IngestCommand& command, const RunContext& context) {
  const std::vector<ingest::SealedPart> parts = ingest::sealed_parts(command.store, made_by(command));
  const nlohmann::json report = gathered_report(command, parts);
  if (!is_gathered(command, [] { return true; })) {
    std::vector<std::filesystem::path> stores;
    for (const ingest::SealedPart& part : parts)
      if (part.report()["stored"] != 0) stores.push_back(part.store());
    if (stores.empty())
      throw Error(ErrorKind::kInput, command.store + ".parts",
                  "no clip was taken, for the reasons in the reports there");
    const std::filesystem::path merging = command.store + ".merging", lock = merging.string() + "-lock";
    std::filesystem::remove(merging);
    std::vector<std::string> order;
    for (const nlohmann::json& clip : report["clips"]) order.push_back(clip["name"].get<std::string>());
    Progress progress;
    store::merge(stores, merging, query::rebuildable(),
                 {.progress = progress.callback(), .stop = context.stop}, order);
    progress.finish();
    {
      store::Store merged = store::Store::open_write(merging);
      update_index(command, merged, context);
    }
    std::filesystem::remove(lock);
    if (!store::rename_to_new(merging, command.store))
      throw Error(ErrorKind::kIo, command.store, fmt::format("cannot be made ({})", std::strerror(errno)),
                  "Run again");
    ingest::remove_unsealed(command.store);
  }
  if (command.json) return print_json(report);
  std::map<std::string, int> counts;
  for (const nlohmann::json& clip : report["clips"]) {
    const auto outcome = clip["outcome"].get<std::string>();
    ++counts[outcome];
    if (outcome != "refused" && outcome != "failed") continue;
    const auto reasons = clip["reasons"].get<std::vector<std::string>>();
    fmt::print("{} {}: {}\n", printable(clip["name"].get<std::string>()), outcome,
               printable(fmt::format("{}", fmt::join(reasons, "; "))));
  }
  fmt::print("{}: {} shards, {} added, {} already there, {} refused, {} failed\n", printable(command.store),
             parts.size(), counts["added"], counts["already there"], counts["refused"], counts["failed"]);
}

void run(const IngestCommand& command, RunContext& context) {
  check_output_folder(command.page);
  ingest::IngestOptions options = command.options;
  options.shard = command.shard.read();
  options.pictures = command.dry_run || !command.page.empty();
  if (command.dry_run) return run_dry(command, options, context);
  if (command.gather) return run_gather(command, context);
  if (command.seal) return run_sealed(command, options, context);
  ingest::GrowingStore growing(command.store, command.paths, options.shard,
                               [&] { return command.settings.for_new_store(); });
  if (!growing.is_new()) command.settings.check_against(growing.settings(), command.store);

  Progress progress;
  const ingest::IngestReport report = ingest::ingest(growing.store(), growing.settings(), command.paths,
                                                     options, shown_on(progress), context.stop);
  progress.finish();
  show(command, report);
  const bool empty = growing.remove_if_empty();
  if (report.stopped) throw *report.stopped;
  if (empty) {
    throw Error(ErrorKind::kInput, command.store, "no clip was taken, for the reasons above",
                growing.is_new() ? "The store was not made" : "");
  }
  update_index(command, growing.store(), context);
  set_exit_code(report, context);
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
  CLI::Option* licence = sub->add_option("--licence", command->options.licence,
                                         "Licence of all given clips; recorded with every use of them");
  CLI::Option* sources = sub->add_option(
      "--sources", command->sources,
      "TOML file of tables [[clip]]: name (of a clip or a folder), licence, author, source; they "
      "are credited (synth animate --credits)");
  CLI::Option* force = sub->add_flag(
      "--force", command->options.force,
      "Take each clip whole, also where screening refuses it (moving camera, cuts, too short); the "
      "findings are still reported");
  sub->add_flag("--steady", command->options.steady,
                "Make steady what a camera in the hand or a slow pan filmed, where enough of it stands, "
                "cropped to what "
                "all frames show. The stored frames then differ from the source's")
      ->excludes(force);
  sub->add_flag("--deinterlace", command->options.repairs.deinterlace,
                "Deinterlace. The stored frames then differ from the source's");
  sub->add_flag("--deblock", command->options.repairs.deblock,
                "Smooth 8 x 8 block borders of coarsely compressed clips. The stored frames then differ from "
                "the source's");
  sub->add_flag(
      "--sdr", command->options.repairs.sdr,
      "Bring HDR clips (PQ, HLG) to SDR: 203 cd/m2 is white, 1000 the brightest. The stored frames then "
      "differ from the source's");
  command->shard.add_to(
      *sub, "Ingest only part I of N of the list, for stores that are built separately and merged [all]");
  CLI::Option* gather =
      sub->add_flag(
             "--gather", command->gather,
             "Merge the sealed parts of all shards into STORE, which must not be there, and index it [off]")
          ->excludes("--shard");
  CLI::Option* seal = sub->add_flag("--seal", command->seal,
                                    "Make the shard in this machine's temporary folder, verify it, and leave "
                                    "it in STORE.parts; one that is there is "
                                    "left. Several machines may share that folder [off]")
                          ->needs("--shard");
  CLI::Option* dry_run = sub->add_flag(
      "--dry-run", command->dry_run,
      "Look only: what would be taken of each clip, why not the rest, what would help. Writes no store");
  CLI::Option* page = sub->add_option("--page", command->page,
                                      "Write a page of all clips (.html): picture, kind of fluid guessed "
                                      "from it, what was taken and why not the rest");
  add_overwrite(*sub);
  sub->get_option("--overwrite")->needs(page);
  licence->excludes(dry_run);
  sources->excludes(dry_run);
  for (CLI::Option* shared : {seal, gather}) shared->excludes(dry_run)->excludes(page);
  CLI::Option* no_index =
      sub->add_flag("--no-index", command->no_index, "Do not update the index at the end")->excludes(dry_run);
  sub->add_flag("--no-flann", command->no_flann,
                "Leave FLANN's index out of the store. Searches with --index flann-hierarchical alone use it")
      ->excludes(no_index)
      ->excludes(dry_run);
  sub->add_flag("--json", command->json, "Print the report as JSON");
  add_threads(*sub);
  command->settings.add_to(*sub);
  sub->callback([command, &context] {
    if (!command->sources.empty()) command->options.sources = read_sources(command->sources);
    run(*command, context);
  });
}

}  // namespace freshet::tools
