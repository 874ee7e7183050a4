#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"
#include "media/frame/frame_md5.h"
#include "media/video/video_writer.h"
#include "platform/printable.h"
#include "starter/starter_store.h"
#include "store/rewrite/rewrite.h"
#include "store/signature.h"
#include "store/store.h"
#include "stored/clip_frames.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "stored/stored_codebook.h"
#include "synth/toml/section.h"
#include "tools/commands.h"
#include "tools/console/output_names.h"
#include "tools/console/progress.h"
#include "tools/console/table.h"
#include "tools/options/target_files.h"

namespace freshet::tools {
namespace {

constexpr std::uint32_t kSlab = 16;  // frames read at once: as tiles hold them

struct StoreCommand {
  std::string store, clip, out, signed_by;
  bool json = false;
};

double fps_of(const store::ClipRecord& clip) {
  return static_cast<double>(clip.fps_num) / static_cast<double>(clip.fps_den);
}

store::ClipId find_clip(const store::Snapshot& snapshot, const std::string& store, const std::string& name) {
  if (const auto id = snapshot.find(name)) return *id;
  std::string names;
  for (store::ClipId id : snapshot.clips()) names += "\n  " + snapshot.clip(id).name;
  throw Error(ErrorKind::kNotFound, store, "it holds no clip named \"" + name + "\"",
              "Its clips are:" + names);
}

/// A clip whose record can be read, with its metadata where they can be, too.
struct ReadableClip {
  store::ClipRecord record;
  std::optional<stored::ClipMetadata> metadata;
};

/// Adds to `faults` what is wrong with metadata; check_account() names the records that cannot be read.
std::vector<ReadableClip> readable_clips(const store::Snapshot& snapshot, std::vector<std::string>& faults) {
  std::vector<ReadableClip> clips;
  for (const store::ClipId id : snapshot.clips()) {
    try {
      clips.push_back({snapshot.clip(id), std::nullopt});
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::kDamaged) throw;
      continue;
    }
    try {
      clips.back().metadata = stored::metadata_of(snapshot, id);
    } catch (const Error& fault) {
      if (fault.kind() != ErrorKind::kDamaged) throw;
      faults.push_back(fault.what());
    }
  }
  return clips;
}

/// Half-lives of a clip's finest and coarsest detail, s.
std::string half_lives_of(const ReadableClip& clip) {
  if (!clip.metadata || !clip.metadata->half_life_s) return "-";
  return fmt::format("{:.2f}-{:.2f}", clip.metadata->half_life_s->front(),
                     clip.metadata->half_life_s->back());
}

/// As JSON; null, and a fault more, where they are none.
nlohmann::json settings_of(const store::Snapshot& snapshot, std::vector<std::string>& faults) {
  nlohmann::json settings = nlohmann::json::parse(snapshot.settings(), nullptr, /*allow_exceptions=*/false);
  if (!settings.is_discarded()) return settings;
  faults.push_back(snapshot.path().string() + ": its settings are no JSON");
  return nullptr;
}

/// Says what is wrong with a store, where something is.
void report_faults(const std::string& store, const std::vector<std::string>& faults, RunContext& context) {
  if (faults.empty()) return;
  say(fmt::format(
      "{}: {} damaged record{}. Restore the file from a copy, or save the clips that are whole: freshet "
      "store repair",
      store, faults.size(), faults.size() == 1 ? "" : "s"));
  context.exit_code = 3;
}

/// What compacting would give back.
std::string gain_text(const std::string& file) {
  const store::FileSizes sizes = store::compacted_size(file);
  if (sizes.after + 4096 * 4 >= sizes.before) return "compact\n";
  return fmt::format("freshet store compact would make it {}, {} less\n",
                     bytes_text(static_cast<double>(sizes.after)),
                     bytes_text(static_cast<double>(sizes.before - sizes.after)));
}

/// What a store can be searched by.
std::string index_text(const store::Snapshot& snapshot) {
  if (!snapshot.blob(stored::kCodebookBlob)) return "none (run freshet index)";
  std::string text = "ready";
  for (const std::string& name : snapshot.blob_names())
    if (name.starts_with("flann-") && snapshot.blob(name)) text += ", " + printable(name);
  return text;
}

/// Numbers come from records' headers: these are compared with what the clips say of them. What they unpack to is not
/// said where that is not so.
void info(const StoreCommand& command, RunContext& context) {
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  std::vector<std::string> faults = snapshot.check_account();
  const bool whole = faults.empty(), one_file = snapshot.files().size() == 1;
  const std::vector<ReadableClip> readable = readable_clips(snapshot, faults);
  const nlohmann::json settings = settings_of(snapshot, faults);
  if (command.json) {
    nlohmann::json json{{"store", command.store}, {"settings", settings}, {"blobs", snapshot.blob_names()}};
    for (const auto& [clip, metadata] : readable) {
      json["clips"].push_back(
          {{"name", clip.name},
           {"class", clip.class_name},
           {"licence", clip.licence},
           {"source", clip.source_hash},
           {"format", clip.pixel_format},
           {"width", clip.width},
           {"height", clip.height},
           {"fps", fps_of(clip)},
           {"frames", clip.frame_count},
           {"patches", clip.rows},
           {"metadata", metadata ? nlohmann::json::parse(clip.metadata) : nlohmann::json()}});
    }
    for (const auto& use : snapshot.usage())
      json["usage"].push_back({{"what", use.what},
                               {"records", use.records},
                               {"stored_bytes", use.stored_bytes},
                               {"raw_bytes", whole ? nlohmann::json(use.raw_bytes) : nlohmann::json()}});
    if (!faults.empty()) json["damaged"] = faults;
    if (whole && one_file) json["compacted_bytes"] = store::compacted_size(command.store).after;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    report_faults(command.store, faults, context);
    return;
  }
  Table clips(
      {"clip", "class", "format", "size", "fps", "frames", "seconds", "half-life s", "patches", "licence"});
  std::uint64_t patches = 0;
  for (const ReadableClip& each : readable) {
    const store::ClipRecord& clip = each.record;
    patches += clip.rows;
    clips.row({clip.name, clip.class_name, clip.pixel_format, fmt::format("{}x{}", clip.width, clip.height),
               fmt::format("{:.2f}", fps_of(clip)), fmt::format("{}", clip.frame_count),
               fmt::format("{:.1f}", clip.frame_count / fps_of(clip)), half_lives_of(each),
               fmt::format("{}", clip.rows), clip.licence});
  }
  Table usage({"what", "records", "stored", "raw", "ratio"});
  for (const auto& use : snapshot.usage())
    usage.row({use.what, fmt::format("{}", use.records), bytes_text(static_cast<double>(use.stored_bytes)),
               whole && use.raw_bytes ? bytes_text(static_cast<double>(use.raw_bytes)) : "-",
               whole && use.raw_bytes && use.stored_bytes
                   ? fmt::format("{:.2f}",
                                 static_cast<double>(use.raw_bytes) / static_cast<double>(use.stored_bytes))
                   : "-"});
  fmt::print("{}\n{} clips, {} patches, index: {}\n\n{}{}\nsettings {}\n", clips.text(), readable.size(),
             patches, index_text(snapshot), usage.text(), whole && one_file ? gain_text(command.store) : "",
             settings.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  for (const std::string& fault : faults) fmt::print("damaged: {}\n", printable(fault));
  report_faults(command.store, faults, context);
}

void verify(const StoreCommand& command, RunContext& context) {
  if (!command.signed_by.empty()) store::expect_signed(command.store, command.signed_by);
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  std::vector<std::string> faults = snapshot.verify();
  readable_clips(snapshot, faults);  // the store itself gives metadata and settings no meaning
  settings_of(snapshot, faults);
  if (command.json)
    fmt::print("{}\n", nlohmann::json{{"store", command.store}, {"damaged", faults}}.dump(
                           2, ' ', false, nlohmann::json::error_handler_t::replace));
  else if (faults.empty())
    fmt::print("{}: every record is as it was written\n", printable(command.store));
  else
    for (const std::string& fault : faults) fmt::print("{}\n", printable(fault));
  report_faults(command.store, faults, context);
}

void digest(const StoreCommand& command) {
  const std::string hash = store::Store::open_read(command.store).snapshot().digest();
  if (command.json)
    fmt::print("{}\n", nlohmann::json{{"store", command.store}, {"digest", hash}}.dump(
                           2, ' ', false, nlohmann::json::error_handler_t::replace));
  else
    fmt::print("{}\n", hash);
}

void framemd5(const StoreCommand& command) {
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  const store::ClipId id = find_clip(snapshot, command.store, command.clip);
  const store::ClipRecord& clip = snapshot.clip(id);
  const stored::ClipFrames frames(snapshot, id);
  fmt::print("{}", media::framemd5_header(frames.layout(), clip.fps_den, clip.fps_num));
  for (std::uint32_t first = 0; first < frames.size(); first += kSlab) {
    const std::uint32_t count = std::min(kSlab, frames.size() - first);
    const std::vector<media::Frame> slab = frames.read(first, count);
    for (std::uint32_t i = 0; i < count; ++i) fmt::print("{}\n", media::framemd5_line(slab[i], first + i, 1));
  }
}

void export_clip(const StoreCommand& command, const RunContext& context) {
  const store::Snapshot snapshot = store::Store::open_read(command.store).snapshot();
  const store::ClipId id = find_clip(snapshot, command.store, command.clip);
  const store::ClipRecord& clip = snapshot.clip(id);
  const stored::ClipFrames frames(snapshot, id);
  check_frames_output(command.out, static_cast<int>(frames.size()));
  const cv::Size size(static_cast<int>(clip.width), static_cast<int>(clip.height));
  const media::OutputFormat format = media::output_format(command.out);
  const bool native = format.coding() == media::Coding::kFfv1;
  say_size(command.out, size);
  const bool varies = stored::kFlowRate.is_in(snapshot, id);
  if (varies && !native)
    say(
        fmt::format("the frame rate of {} varies; what is written has all frames, evenly, at the mean of "
                    "{:.2f} frames/s; .mkv keeps their times",
                    clip.name, fps_of(clip)));
  media::VideoWriter writer(
      command.out, size, {.fps_num = clip.fps_num, .fps_den = clip.fps_den, .own_times = varies && native});
  Progress progress;
  for (std::uint32_t first = 0; first < frames.size(); first += kSlab) {
    if (context.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "export", "stopped");
    const std::uint32_t count = std::min(kSlab, frames.size() - first);
    for (const media::Frame& frame : frames.read(first, count)) {
      if (native)
        writer.write(frame);
      else
        writer.write(media::as_held(media::to_bgr(frame), format));
    }
    progress.show("export", first + count, frames.size(), "frames");
  }
  writer.finish();
  progress.finish();
  fmt::print("{}\n", command.out);
}

struct StarterCommand {
  std::string out, recipe;
  bool print = false;
};

void make_starter(const StarterCommand& command, const RunContext& context) {
  const starter::Recipe recipe =
      command.recipe.empty()
          ? starter::own_recipe()
          : starter::parse_recipe(synth::toml_file_text(command.recipe, "Give a TOML file"), command.recipe);
  if (command.print) {
    fmt::print("{}", recipe.text);
    return;
  }
  if (command.out.empty()) throw CLI::RequiredError("--output");
  check_output_folder(command.out);
  Progress progress;
  starter::make_store(command.out, recipe, {.progress = progress.callback(), .stop = context.stop});
  progress.finish();
  fmt::print("{}\n", command.out);
}

}  // namespace

void add_store(CLI::App& app, RunContext& context) {
  CLI::App* store =
      app.add_subcommand("store", "Look into a store, check it, repair it, and take clips out again");
  store->require_subcommand(1);
  const auto add = [&](const char* name, const char* text, bool takes_clip, bool takes_json, auto&& act) {
    auto command = std::make_shared<StoreCommand>();
    CLI::App* sub = store->add_subcommand(name, text);
    sub->add_option("STORE", command->store, "The store file")->required();
    if (takes_clip)
      sub->add_option("CLIP", command->clip, "The clip's name, as freshet store info lists it")->required();
    if (takes_json) sub->add_flag("--json", command->json, "Print the result as JSON");
    add_threads(*sub);
    sub->callback([command, act] { act(*command); });
    return std::pair(sub, command);
  };
  add("info",
      "Clips, patches, settings, and bytes by what they hold; exit code 3 when records are not those that "
      "were "
      "written, as far as their headers tell",
      false, true, [&context](const StoreCommand& c) { info(c, context); });
  auto [verifying, verified] =
      add("verify", "Check the place and the hash of every record; exit code 3 if one is damaged", false,
          true, [&context](const StoreCommand& c) { verify(c, context); });
  verifying
      ->add_option("--signed-by", verified->signed_by,
                   "Public key of minisign, or its file, that must have signed the store (STORE.minisig)")
      ->check(fault_of_key);
  add("digest",
      "One hash of all logical content: equal for equal clips and settings, whatever the order or threads",
      false, true, [](const StoreCommand& c) { digest(c); });
  add("framemd5", "MD5 of every frame of a clip, as `ffmpeg -i SOURCE -f framemd5 -` prints for its source",
      true, false, [](const StoreCommand& c) { framemd5(c); });
  auto [sub, command] =
      add("export", "Write a clip back, without loss (.mkv: FFV1 in its native planes) or as pictures", true,
          false, [&context](const StoreCommand& c) { export_clip(c, context); });
  sub->add_option("-o,--output", command->out, "NAME.mkv, or a numbered sequence such as frames/%05d.png")
      ->required();
  add_overwrite(*sub);
  CLI::App* made =
      store->add_subcommand("starter",
                            "Make the store that commands use by default: simulated clips of water, "
                            "fire, smoke and clouds");
  auto starter = std::make_shared<StarterCommand>();
  made->add_option("-o,--output", starter->out, "The store file");
  made->add_option(
      "--recipe", starter->recipe,
      "TOML file of clips, each a table [[clip]] with a name (CLASS/NAME) and the keys of a ready-made clip "
      "(synth simulate --keys) [Freshet's own]");
  made->add_flag("--print-recipe", starter->print, "Print the recipe, to be edited")->excludes("--output");
  add_threads(*made);
  made->callback([starter, &context] { make_starter(*starter, context); });
  add_store_page(*store, context);
  add_store_rewrites(*store, context);
}

}  // namespace freshet::tools
