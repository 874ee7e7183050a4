#include "ingest/ingest.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <new>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "ingest/clip_analysis.h"
#include "ingest/clip_pipeline.h"
#include "ingest/frame_timing.h"
#include "media/video/frame_stamps.h"
#include "media/video/video_reader.h"
#include "platform/stopwatch.h"
#include "stored/clip_columns.h"
#include "stored/clip_metadata.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kMaxSide =
    32768;  // px: patch corners are kept in 16 bits, also in a frame turned by 45 degrees

json screening_json(const Screening& screening, const Verdict& verdict) {
  return {{"frames", screening.frames},
          {"camera",
           {{"windows", screening.camera.windows},
            {"referenced_windows", screening.camera.referenced_windows},
            {"drift", screening.camera.drift},
            {"shake", screening.camera.shake}}},
          {"cuts", screening.cuts},
          {"duplicated_share", screening.duplicated_fraction},
          {"static_share", screening.static_fraction},
          {"truncated", screening.truncated},
          {"overridden", verdict.refusals}};
}

/// No times and no paths: the same clip has the same metadata wherever and however fast it was read.
stored::ClipMetadata metadata_of(const media::VideoInfo& info, const ClipMeasures& measures,
                                 const Verdict& verdict, const ClipReport& report,
                                 const media::Repairs& repairs) {
  return {.layout = info.layout,
          .codec = info.codec,
          .container = info.container,
          .variable_frame_rate = !measures.screening.timing.steady,
          .repairs = media::filter_text(repairs),
          .notices = report.notes,
          .cells = stored::shapes_of(measures.columns),
          .patches = report.patches_by_variant,
          .loop = measures.loop,
          .half_life_s = measures.half_life_s,
          .standing = measures.standing,
          .more = {{"screening", screening_json(measures.screening, verdict)}}};
}

/// Faults that need no frame to be seen, none of which force overrides.
void check_fit(const media::VideoInfo& info, const Source& source, const vision::Settings& settings) {
  const media::PixelLayout& layout = info.layout;
  const std::string where = source.path.string();
  const int minimum = std::max(16, min_side(settings));  // 16: vision::optical_flow
  if (std::min(layout.width, layout.height) < minimum) {
    throw Error(
        ErrorKind::kInput, where,
        fmt::format("{} x {} px is too small: no patch of {} px lies in it, even at the largest scale",
                    layout.width, layout.height, settings.grid.patch),
        fmt::format("Give a clip of at least {} x {} px", minimum, minimum));
  }
  if (std::max(layout.width, layout.height) > kMaxSide) {
    throw Error(ErrorKind::kInput, where,
                fmt::format("{} x {} px is too large, {} px per side is the limit", layout.width,
                            layout.height, kMaxSide),
                "Scale it down first");
  }
  constexpr int kPq = 16, kHlg = 18;  // ITU-T H.273, transfer characteristics
  if (layout.transfer == kPq || layout.transfer == kHlg)
    throw Error(
        ErrorKind::kInput, where,
        fmt::format("it is HDR ({}): read as the sRGB that we work in, its colours would be pale and wrong",
                    layout.transfer == kPq ? "PQ" : "HLG"),
        "Film in SDR, or export it as SDR (BT.709) from your editing program");
}

/// Where a file's stamps tell another mean rate than its header, they are right.
void take_stamped_rate(const fs::path& path, store::ClipRecord& record) {
  constexpr double kWrong = 0.01;
  const double claimed = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  const double stamped = timing_of(media::frame_stamps(path)).fps;
  if (!(stamped > 0.5 && stamped < 2000) || std::abs(stamped / claimed - 1) <= kWrong) return;
  record.fps_num = std::llround(stamped * 1000);
  record.fps_den = 1000;
}

/// The fault and its remedy: a row of the report names its clip already.
std::string without_path(const Error& error, const fs::path& path) {
  const std::string text = error.what(), where = path.string() + ": ";
  return text.starts_with(where) ? text.substr(where.size()) : text;
}

/// One source, from path to row.
class ClipIngest {
 public:
  ClipIngest(store::Store& store, const vision::Settings& settings, const IngestOptions& options)
      : store_(store), settings_(settings), options_(options) {}

  /// Throws Error for what ends the run; everything else is in the row.
  ClipReport run(const Source& source, const std::function<void(std::uint32_t, std::uint32_t)>& on_slab,
                 const std::stop_token& stop) {
    ClipReport report;
    report.name = source.name;
    report.path = source.path;
    report.class_name = options_.class_name.empty() ? source.class_name : options_.class_name;
    try {
      const TimedScope total(report.seconds.total);
      add(source, on_slab, stop, report);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kInput) throw;
      fail(report, without_path(error, source.path));
    } catch (const std::bad_alloc&) {
      fail(report, "the memory does not suffice for this clip; scale it down first");
    } catch (const cv::Exception& error) {
      fail(report, "it could not be analysed: " + error.err);
    } catch (const std::exception& error) {
      fail(report, fmt::format("it could not be analysed: {}", error.what()));
    }
    if (!hash_.empty()) seen_.try_emplace(std::exchange(hash_, {}), report);
    return report;
  }

 private:
  static void fail(ClipReport& report, std::string reason) {
    report.outcome = Outcome::kFailed;
    report.reasons = {std::move(reason)};
  }

  /// True when there is nothing to do; the row then says why.
  bool settled(const Source& source, ClipReport& report) {
    const store::Snapshot snapshot = store_.snapshot();
    const std::optional<store::ClipId> same_name = snapshot.find(source.name);
    if (same_name && options_.skip_existing) {
      report.outcome = Outcome::kAlreadyThere;
      report.reasons = {"a clip of this name is in the store"};
      return true;
    }
    {
      const TimedScope watch(report.seconds.hash);
      hash_ = source_hash(source.path);
    }
    if (const auto seen = seen_.find(hash_); seen != seen_.end()) {
      const ClipReport& twin = seen->second;
      const bool there = twin.outcome == Outcome::kAdded || twin.outcome == Outcome::kAlreadyThere;
      report.outcome = there ? Outcome::kAlreadyThere : twin.outcome;
      report.reasons = {fmt::format("the same bytes as \"{}\" of this run, which is {}", twin.name,
                                    there ? "in the store" : to_string(twin.outcome))};
      return true;
    }
    if (const auto same_source = snapshot.find_source(hash_)) {
      report.outcome = Outcome::kAlreadyThere;
      const std::string& name = snapshot.clip(*same_source).name;
      report.reasons = {name == source.name ? std::string("its bytes are in the store")
                                            : fmt::format("its bytes are in the store as \"{}\"", name)};
      return true;
    }
    if (same_name) {
      throw Error(ErrorKind::kInput, source.path.string(),
                  fmt::format("the store holds another clip named \"{}\"", source.name),
                  "Rename the file, or give the folder above it so that its name differs");
    }
    return false;
  }

  void add(const Source& source, const std::function<void(std::uint32_t, std::uint32_t)>& on_slab,
           const std::stop_token& stop, ClipReport& report) {
    if (settled(source, report)) return;
    // A picture turned by a quarter is the same picture: what lies is set upright, unasked.
    media::Repairs repairs = options_.repairs;
    repairs.upright = true;
    media::VideoReader reader(source.path, 0, repairs);
    const media::VideoInfo info = reader.info();
    report.width = static_cast<std::uint32_t>(info.layout.width);
    report.height = static_cast<std::uint32_t>(info.layout.height);
    check_fit(info, source, settings_);
    store::ClipRecord record;
    record.fps_num = info.fps_num;
    record.fps_den = info.fps_den;
    const double claimed = info.fps_den > 0 ? static_cast<double>(info.fps_num) / info.fps_den : 0;
    if (!(claimed > 0.5 && claimed < 2000)) {
      report.notes.push_back(fmt::format("its header claims {} / {} frames per second; 25 are taken",
                                         info.fps_num, info.fps_den));
      record.fps_num = 25;
      record.fps_den = 1;
    }
    take_stamped_rate(source.path, record);
    report.fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
    if (info.turned != 0)
      report.notes.push_back(fmt::format(
          "its frames are stored lying; they are kept upright, turned by {} degrees as players do",
          info.turned));

    const std::uint64_t bytes_before = file_size();
    store::ClipWriter writer = store_.add_clip();
    const auto frames_claimed =
        static_cast<std::uint32_t>(std::clamp<std::int64_t>(info.claimed_frames, 0, 1 << 30));
    ClipMeasures measures = stream_clip(
        reader, report.fps, source.path.string(), settings_, writer,
        [&](std::uint32_t frames) {
          report.frames = frames;
          on_slab(frames, frames_claimed);
        },
        stop, report.seconds);
    if (!reader.complaint().empty()) {
      measures.screening.truncated = true;
      report.notes.push_back(reader.complaint());
    }
    report.screening = measures.screening;

    stored::PatchColumns& patches = measures.columns.patches;
    {
      const TimedScope watch(report.seconds.patches);
      patches = find_patches(measures.moving, measures.columns.motion, settings_);
    }
    Verdict verdict = judge(measures.screening, options_.limits);
    report.notes.insert(report.notes.end(), verdict.notes.begin(), verdict.notes.end());
    if (!verdict.refusals.empty() && !options_.force) {
      report.outcome = Outcome::kRefused;
      report.reasons = std::move(verdict.refusals);
      return;
    }
    if (patches.size() == 0) {
      throw Error(
          ErrorKind::kInput, source.path.string(),
          fmt::format(
              "no patch is left: {:.1f} % of its pixels move, and no {} px square of it does by {:.0f} %",
              100 * (1 - measures.screening.static_fraction), settings_.grid.patch,
              100 * settings_.min_coverage),
          "Give a clip with more motion, or a store with lower limits of motion and coverage");
    }
    report.patches = patches.size();
    report.patches_by_variant.assign(settings_.variants().size(), 0);
    for (const std::uint8_t variant : patches.variant) ++report.patches_by_variant[variant];

    record.name = source.name;
    record.class_name = report.class_name;
    record.licence = options_.licence;
    record.source_hash = hash_;
    record.pixel_format = info.layout.format;
    record.width = report.width;
    record.height = report.height;
    record.metadata = to_json(metadata_of(info, measures, verdict, report, options_.repairs));
    {
      const TimedScope watch(report.seconds.commit);
      stored::write_columns(writer, measures.columns);
      writer.commit(std::move(record));
    }
    report.reasons = std::move(verdict.refusals);
    report.outcome = Outcome::kAdded;
    const std::uint64_t bytes_after = file_size();
    report.stored_bytes = bytes_after > bytes_before ? bytes_after - bytes_before : 0;
  }

  std::uint64_t file_size() const {
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(store_.path(), error);
    return error ? 0 : bytes;
  }

  store::Store& store_;
  const vision::Settings& settings_;
  const IngestOptions& options_;
  std::string hash_;                        // of the clip in hand
  std::map<std::string, ClipReport> seen_;  // of this run, by source hash
};

}  // namespace

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kAdded:
      return "added";
    case Outcome::kAlreadyThere:
      return "already there";
    case Outcome::kRefused:
      return "refused";
    case Outcome::kFailed:
      return "failed";
  }
  return "";
}

std::size_t IngestReport::count(Outcome outcome) const {
  return static_cast<std::size_t>(std::ranges::count(clips, outcome, &ClipReport::outcome));
}

IngestReport ingest(store::Store& store, const vision::Settings& settings, std::span<const fs::path> paths,
                    const IngestOptions& options, const std::function<void(const IngestProgress&)>& progress,
                    std::stop_token stop) {
  const std::vector<Source> sources = list_sources(paths, options.shard);
  IngestReport report;
  ClipIngest clip(store, settings, options);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    IngestProgress at{.clip = i, .clips = sources.size(), .source = &sources[i]};
    const auto notify = [&] {
      if (progress) progress(at);
    };
    notify();
    try {
      if (stop.stop_requested())
        throw Error(ErrorKind::kCancelled, sources[i].path.string(), "stopped before it");
      report.clips.push_back(clip.run(
          sources[i],
          [&](std::uint32_t frames, std::uint32_t claimed) {
            at.frames = frames;
            at.claimed_frames = claimed;
            notify();
          },
          stop));
    } catch (const Error& error) {
      report.stopped = error;
      return report;
    }
    at.finished = &report.clips.back();
    notify();
  }
  return report;
}

}  // namespace freshet::ingest
