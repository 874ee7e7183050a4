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
#include "media/frame/frame_warp.h"
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
  json values{{"frames", screening.frames},
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
  if (screening.crossed_fraction > 0) values["crossed_share"] = screening.crossed_fraction;
  return values;
}

/// No times and no paths: the same clip has the same metadata wherever and however fast it was read.
stored::ClipMetadata metadata_of(const media::VideoInfo& info, const ClipMeasures& measures,
                                 const Verdict& verdict, const ClipReport& report, json part) {
  json more{{"screening", screening_json(measures.screening, verdict)}};
  if (!part.is_null()) more["part"] = std::move(part);
  return {.layout = info.layout,
          .codec = info.codec,
          .container = info.container,
          .variable_frame_rate = !measures.screening.timing.steady,
          .repairs = info.repairs,
          .notices = report.notes,
          .cells = stored::shapes_of(measures.columns),
          .patches = report.patches_by_variant,
          .loop = measures.loop,
          .half_life_s = measures.half_life_s,
          .standing = measures.standing,
          .more = std::move(more)};
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
        "Bring it to SDR with --sdr, film in SDR, or export it as SDR (BT.709) from your editing program");
}

constexpr double kOtherRate = 0.01;  // rates that differ by more than this share are not the same

/// Where a file's stamps tell another mean rate than its header, they are right.
void take_stamped_rate(const fs::path& path, store::ClipRecord& record) {
  const double claimed = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  const double stamped = timing_of(media::frame_stamps(path)).fps;
  if (!(stamped > 0.5 && stamped < 2000) || std::abs(stamped / claimed - 1) <= kOtherRate) return;
  record.fps_num = std::llround(stamped * 1000);
  record.fps_den = 1000;
}

/// The fault and its remedy: a row of the report names its clip already.
std::string without_path(const Error& error, const fs::path& path) {
  const std::string text = error.what(), where = path.string() + ": ";
  return text.starts_with(where) ? text.substr(where.size()) : text;
}

/// Of a source that is in the store in parts: how many of them are there, and how many there are to be.
struct PartsThere {
  std::size_t there = 0, of = 0;
  std::string first;  // name
};

PartsThere parts_there(const store::Snapshot& snapshot, const std::string& hash) {
  PartsThere parts;
  for (const store::ClipId id : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(id);
    if (record.name.find('@') == std::string::npos) continue;  // no part; only those need their metadata read
    const json part = stored::metadata_of(snapshot, id).more.value("part", json());
    if (!part.is_object() || part.value("source", "") != hash) continue;
    if (parts.there++ == 0) parts.first = record.name;
    parts.of = part.value("of", std::size_t{0});
  }
  return parts;
}

/// One source, from path to rows.
class ClipIngest {
 public:
  using OnFrames = std::function<void(bool surveying, std::uint32_t frames, std::uint32_t claimed)>;

  ClipIngest(store::Store& store, const vision::Settings& settings, const IngestOptions& options)
      : store_(&store), writable_(&store), settings_(settings), options_(options), alike_(&store) {}
  /// Only looks. store   null: there is none.
  ClipIngest(const store::Store* store, const vision::Settings& settings, const IngestOptions& options)
      : store_(store), preview_(true), settings_(settings), options_(options), alike_(store) {}

  /// Appends the rows, each when it is finished.
  /// Throws Error for what ends the run; everything else is in the rows.
  void run(const Source& source, const OnFrames& on_frames, const std::function<void(ClipReport)>& finish,
           const std::stop_token& stop) {
    ClipReport blank;
    blank.name = source.name;
    blank.path = source.path;
    blank.class_name = options_.class_name.empty() ? source.class_name : options_.class_name;
    const auto end_row = [&](ClipReport&& row) {
      const bool there = row.outcome == Outcome::kAdded || row.outcome == Outcome::kAlreadyThere ||
                         row.outcome == Outcome::kWouldAdd;
      if (options_.pictures && row.look.jpeg.empty() && !row.part) row.look = look_of_first_frame(row.path);
      // Of a source in parts, one that was taken speaks for it.
      if (row.outcome == Outcome::kAdded || row.outcome == Outcome::kWouldAdd) note_alike(row);
      if (!hash_.empty() && (there || !seen_.contains(hash_))) seen_.insert_or_assign(hash_, row);
      finish(std::move(row));
    };
    ClipReport row = blank;
    const Stopwatch all;
    if (guarded(row, [&] { return settled(source, row) || look(source, row, on_frames, stop); })) {
      row.seconds.total = all.seconds();
      end_row(std::move(row));
    } else {
      take(source, row, on_frames, end_row, stop);
    }
    hash_.clear();
    reader_.reset();
  }

 private:
  /// Of a row that is taken. After its clip was written: what else a store holds is no part of a clip's metadata.
  void note_alike(ClipReport& row) {
    if (!survey_.trace) return;
    const Span span = row.part.value_or(survey_.whole);
    const FilmTrace trace = survey_.trace->part(span.first, span.last);
    row.alike = alike_.find(row.name, trace);
    alike_.add(row.name, trace, !preview_);
    if (row.alike)
      row.notes.push_back(
          fmt::format("for {:.1f} s it shows what \"{}\" shows: of two copies only one is needed",
                      row.alike->seconds, row.alike->name));
  }

  /// True also when the work failed for its clip's sake; the row then says why.
  bool guarded(ClipReport& row, const std::function<bool()>& work) {
    try {
      return work();
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kInput) throw;
      fail(row, without_path(error, row.path));
    } catch (const std::bad_alloc&) {
      fail(row, "the memory does not suffice for this clip; scale it down first");
    } catch (const cv::Exception& error) {
      fail(row, "it could not be analysed: " + error.err);
    } catch (const std::exception& error) {
      fail(row, fmt::format("it could not be analysed: {}", error.what()));
    }
    return true;
  }

  static void fail(ClipReport& report, std::string reason) {
    report.outcome = Outcome::kFailed;
    report.reasons = {std::move(reason)};
  }

  /// True when there is nothing to do; the row then says why.
  bool settled(const Source& source, ClipReport& report) {
    std::optional<store::Snapshot> snapshot;
    if (store_) snapshot.emplace(store_->snapshot());
    std::optional<store::ClipId> same_name;
    if (snapshot) same_name = snapshot->find(source.name);
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
      const bool taken = there || twin.outcome == Outcome::kWouldAdd;
      report.outcome = taken ? Outcome::kAlreadyThere : twin.outcome;
      report.reasons = {fmt::format("the same bytes as \"{}\" of this run, which {}{}", twin.name,
                                    twin.outcome == Outcome::kWouldAdd ? "" : "is ",
                                    there ? "in the store" : to_string(twin.outcome))};
      return true;
    }
    if (!snapshot) return false;
    if (const auto same_source = snapshot->find_source(hash_)) {
      report.outcome = Outcome::kAlreadyThere;
      const std::string& name = snapshot->clip(*same_source).name;
      report.reasons = {name == source.name ? std::string("its bytes are in the store")
                                            : fmt::format("its bytes are in the store as \"{}\"", name)};
      return true;
    }
    if (const PartsThere parts = parts_there(*snapshot, hash_); parts.there > 0 && parts.there == parts.of) {
      report.outcome = Outcome::kAlreadyThere;
      report.reasons = {fmt::format("its {} part{} in the store, the first as \"{}\"", parts.of,
                                    parts.of == 1 ? " is" : "s are", parts.first)};
      return true;
    }
    if (same_name) {
      throw Error(ErrorKind::kInput, source.path.string(),
                  fmt::format("the store holds another clip named \"{}\"", source.name),
                  "Rename the file, or give the folder above it so that its name differs");
    }
    return false;
  }

  /// Opens the source, and finds what of it can be taken. True when the row says all there is to say.
  bool look(const Source& source, ClipReport& report, const OnFrames& on_frames,
            const std::stop_token& stop) {
    open(source);
    const media::VideoInfo& info = reader_->info();
    report.width = static_cast<std::uint32_t>(info.layout.width);
    report.height = static_cast<std::uint32_t>(info.layout.height);
    check_fit(info, source, settings_);
    record_ = {};
    record_.fps_num = info.fps_num;
    record_.fps_den = info.fps_den;
    const double claimed = info.fps_den > 0 ? static_cast<double>(info.fps_num) / info.fps_den : 0;
    if (!(claimed > 0.5 && claimed < 2000)) {
      report.notes.push_back(fmt::format("its header claims {} / {} frames per second; 25 are taken",
                                         info.fps_num, info.fps_den));
      record_.fps_num = 25;
      record_.fps_den = 1;
    }
    take_stamped_rate(source.path, record_);
    report.fps = static_cast<double>(record_.fps_num) / static_cast<double>(record_.fps_den);
    if (info.turned != 0)
      report.notes.push_back(fmt::format(
          "its frames are stored lying; they are kept upright, turned by {} degrees as players do",
          info.turned));
    frames_claimed_ = static_cast<std::uint32_t>(std::clamp<std::int64_t>(info.claimed_frames, 0, 1 << 30));
    survey_ = {};
    if (options_.force && !options_.pictures && !preview_) return false;
    const TimedScope watch(report.seconds.survey);
    survey_ = survey(
        *reader_, report.fps, options_.limits, options_.steady, options_.pictures, source.path.string(),
        [&](std::uint32_t frames) { on_frames(true, frames, frames_claimed_); }, stop);
    open(source);
    if (options_.force && survey_.in_parts()) {
      Piece whole{survey_.whole, {}, {}, {}, survey_.pieces.front().look, {}};
      for (const Piece& piece : survey_.pieces)
        whole.refusals.insert(whole.refusals.end(), piece.refusals.begin(), piece.refusals.end());
      survey_.pieces = {std::move(whole)};
    }
    if (survey_.in_parts()) return false;
    Piece& only = survey_.pieces.front();
    report.frames = static_cast<std::uint32_t>(survey_.whole.frames());
    report.look = std::move(only.look);
    if (only.fit() || options_.force) return false;
    report.outcome = Outcome::kRefused;
    report.reasons = std::move(only.refusals);
    report.help = std::move(only.help);
    if (!survey_.complaint.empty()) report.notes.push_back(survey_.complaint);
    return true;
  }

  /// A picture turned by a quarter is the same picture: what lies is set upright, unasked.
  void open(const Source& source) {
    media::Repairs repairs = options_.repairs;
    repairs.upright = true;
    reader_.emplace(source.path, 0, repairs);
    frames_read_ = 0;
  }

  /// Of a source that was not looked at.
  PartLook look_of_first_frame(const fs::path& path) const {
    try {
      media::VideoReader reader(path, 1, {.upright = true});
      const std::optional<media::Frame> frame = reader.next();
      if (!frame) return {};
      FilmLook film(1);
      film.add(*frame, media::to_luma(*frame));
      return {film.look(0, 1).jpeg, {}};
    } catch (const std::exception&) {  // the row says already what is wrong with it
      return {};
    }
  }

  /// The next frame of the source.
  std::optional<media::Frame> next_frame() {
    std::optional<media::Frame> frame = reader_->next();
    if (frame) ++frames_read_;
    return frame;
  }

  /// All that the first look found fit, in one pass over the source, and a row for what it did not.
  void take(const Source& source, const ClipReport& looked, const OnFrames& on_frames,
            const std::function<void(ClipReport&&)>& end_row, const std::stop_token& stop) {
    if (!survey_.in_parts()) {
      ClipReport row = looked;
      const Stopwatch all;
      if (preview_) {
        row.outcome = Outcome::kWouldAdd;
        row.reasons = survey_.pieces.front().refusals;  // what force overrides
        row.notes.insert(row.notes.end(), survey_.pieces.front().notes.begin(),
                         survey_.pieces.front().notes.end());
        if (!survey_.complaint.empty()) row.notes.push_back(survey_.complaint);
        row.seconds.total = row.seconds.survey + row.seconds.hash;
        return end_row(std::move(row));
      }
      guarded(row, [&] {
        add(
            source, nullptr, {}, [&] { return next_frame(); }, on_frames, stop, row);
        return true;
      });
      row.seconds.total = all.seconds() + looked.seconds.survey + looked.seconds.hash;
      return end_row(std::move(row));
    }
    std::size_t number = 0;
    const std::size_t of = static_cast<std::size_t>(survey_.fit());
    for (const Piece& piece : survey_.pieces) {
      ClipReport row = looked;
      if (&piece != &survey_.pieces.front()) row.seconds = {};
      row.part = piece.span;
      row.name = part_name(source.name, piece.span);
      row.frames = static_cast<std::uint32_t>(piece.span.frames());
      row.look = piece.look;
      if (piece.steady) say_steadied(*piece.steady, row);
      const Stopwatch all;
      if (piece.fit() && preview_) {
        row.outcome = Outcome::kWouldAdd;
        row.notes.insert(row.notes.end(), piece.notes.begin(), piece.notes.end());
      } else if (piece.fit()) {
        json part{{"source", hash_},         {"from_s", piece.span.from_s},
                  {"to_s", piece.span.to_s}, {"first_frame", piece.span.first},
                  {"number", ++number},      {"of", of}};
        if (piece.steady)
          part["steady"] = {{"width", piece.steady->size.width},
                            {"height", piece.steady->size.height},
                            {"kept", piece.steady->kept}};
        guarded(row, [&] {
          add_part(source, piece, part, on_frames, stop, row);
          return true;
        });
      } else {
        row.outcome = Outcome::kRefused;
        row.reasons = piece.refusals;
        row.help = piece.help;
      }
      row.seconds.total = all.seconds() + row.seconds.survey + row.seconds.hash;
      if (&piece == &survey_.pieces.back() && !survey_.complaint.empty())
        row.notes.push_back(survey_.complaint);
      end_row(std::move(row));
    }
  }

  static void say_steadied(const SteadyPath& path, ClipReport& row) {
    row.steadied_kept = path.kept;
    row.width = static_cast<std::uint32_t>(path.size.width);
    row.height = static_cast<std::uint32_t>(path.size.height);
    row.notes.push_back(
        fmt::format("made steady: its frames are not the source's own, and show the {:.0f} % that all of "
                    "them have in common",
                    100 * path.kept));
  }

  void add_part(const Source& source, const Piece& piece, const json& part, const OnFrames& on_frames,
                const std::stop_token& stop, ClipReport& row) {
    const Span& span = piece.span;
    {
      const store::Snapshot snapshot = store_->snapshot();
      if (snapshot.find_source(hash_of(piece))) {
        row.outcome = Outcome::kAlreadyThere;
        row.reasons = {"it is in the store"};
        return;
      }
      if (snapshot.find(row.name))
        throw Error(ErrorKind::kInput, source.path.string(),
                    fmt::format("the store holds another clip named \"{}\"", row.name),
                    "Rename the file, or give the folder above it so that its name differs");
    }
    if (piece.steady && std::min(piece.steady->size.width, piece.steady->size.height) < min_side(settings_))
      throw Error(ErrorKind::kInput, source.path.string(),
                  fmt::format("{} x {} px are left of it when it is made steady, too few for a patch",
                              piece.steady->size.width, piece.steady->size.height),
                  kStandStill);
    while (frames_read_ < span.first) {
      if (stop.stop_requested())
        throw Error(ErrorKind::kCancelled, source.path.string(), "stopped; the clip was not added");
      if (!next_frame())
        throw Error(ErrorKind::kInput, source.path.string(), "it ends earlier than at the first look",
                    "Ingest it again when nothing changes it");
    }
    add(
        source, &piece, part,
        [&]() -> std::optional<media::Frame> {
          if (frames_read_ >= span.last) return std::nullopt;
          std::optional<media::Frame> frame = next_frame();
          if (!frame) return frame;
          frame->time_s -= span.from_s;
          if (piece.steady)
            frame = media::warped(*frame, piece.steady->source_from_steady[frames_read_ - 1 - span.first],
                                  piece.steady->size);
          return frame;
        },
        on_frames, stop, row);
  }

  std::string hash_of(const Piece& piece) const {
    return part_hash(hash_, piece.span.first, piece.span.last, piece.steady.has_value());
  }

  /// A part's mean rate, where its source's is another.
  void take_measured_rate(const FrameTiming& timing, store::ClipRecord& record) const {
    const double source_fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
    if (timing.fps <= 0 || std::abs(timing.fps / source_fps - 1) <= kOtherRate) return;
    record.fps_num = std::llround(timing.fps * 1000);
    record.fps_den = 1000;
  }

  /// What `next` gives becomes a clip. piece, part   of a source that is taken in parts, null otherwise.
  void add(const Source& source, const Piece* piece, const json& part, const FrameSource& next,
           const OnFrames& on_frames, const std::stop_token& stop, ClipReport& report) {
    store::ClipRecord record = record_;
    const std::uint64_t bytes_before = file_size();
    store::ClipWriter writer = writable_->add_clip();
    ClipMeasures measures = stream_clip(
        next, report.fps, source.path.string(), settings_, writer,
        [&](std::uint32_t frames) {
          report.frames = frames;
          on_frames(false, piece ? static_cast<std::uint32_t>(frames_read_) : frames, frames_claimed_);
        },
        stop, report.seconds);
    if (!piece && !reader_->complaint().empty()) {
      measures.screening.truncated = true;
      report.notes.push_back(reader_->complaint());
    }
    if (piece) take_measured_rate(measures.screening.timing, record);
    report.screening = measures.screening;

    stored::PatchColumns& patches = measures.columns.patches;
    {
      const TimedScope watch(report.seconds.patches);
      patches = find_patches(measures.moving, measures.crossed, measures.columns.motion, settings_);
    }
    Verdict verdict = judge(measures.screening, options_.limits);
    report.notes.insert(report.notes.end(), verdict.notes.begin(), verdict.notes.end());
    if (!verdict.refusals.empty() && !options_.force) {
      report.outcome = Outcome::kRefused;
      report.reasons = std::move(verdict.refusals);
      return;
    }
    if (patches.size() == 0) {
      const double crossed = measures.screening.crossed_fraction;
      throw Error(
          ErrorKind::kInput, source.path.string(),
          fmt::format(
              "no patch is left: {:.1f} % of its pixels move,{} and no {} px square{} moves by {:.0f} %",
              100 * (1 - measures.screening.static_fraction),
              crossed > 0 ? fmt::format(" something crosses {:.1f} %,", 100 * crossed) : "",
              settings_.grid.patch, crossed > 0 ? " that nothing crosses" : "", 100 * settings_.min_coverage),
          "Give a clip with more motion, or a store with lower limits of motion and coverage");
    }
    report.patches = patches.size();
    report.patches_by_variant.assign(settings_.variants().size(), 0);
    for (const std::uint8_t variant : patches.variant) ++report.patches_by_variant[variant];

    record.name = report.name;
    record.class_name = report.class_name;
    const ClipSource* const found = source_of(options_.sources, report.name);
    const ClipSource said = found != nullptr ? *found : ClipSource();
    record.licence = said.licence.empty() ? options_.licence : said.licence;
    media::VideoInfo info = reader_->info();
    info.layout.width = static_cast<int>(report.width);
    info.layout.height = static_cast<int>(report.height);
    record.source_hash = piece ? hash_of(*piece) : hash_;
    record.pixel_format = info.layout.format;
    record.width = report.width;
    record.height = report.height;
    stored::ClipMetadata metadata = metadata_of(info, measures, verdict, report, part);
    metadata.author = said.author;
    metadata.source = said.source;
    record.metadata = to_json(metadata);
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
    const std::uintmax_t bytes = fs::file_size(store_->path(), error);
    return error ? 0 : bytes;
  }

  const store::Store* store_ = nullptr;
  store::Store* writable_ = nullptr;
  bool preview_ = false;
  const vision::Settings& settings_;
  const IngestOptions& options_;
  // Of the source in hand:
  std::string hash_;
  std::optional<media::VideoReader> reader_;
  int frames_read_ = 0;
  std::uint32_t frames_claimed_ = 0;
  store::ClipRecord record_;  // its rate
  Survey survey_;

  AlikeClips alike_;
  std::map<std::string, ClipReport> seen_;  // of this run, by source hash
};

}  // namespace

const char* to_string(Outcome outcome) {
  switch (outcome) {
    case Outcome::kAdded:
      return "added";
    case Outcome::kWouldAdd:
      return "would be added";
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

namespace {

IngestReport run_all(ClipIngest& clip, std::span<const fs::path> paths, Shard shard,
                     const std::function<void(const IngestProgress&)>& progress,
                     const std::stop_token& stop) {
  const std::vector<Source> sources = list_sources(paths, shard);
  IngestReport report;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    IngestProgress at{.clip = i, .clips = sources.size(), .source = &sources[i]};
    const auto notify = [&] {
      if (progress) progress(at);
    };
    notify();
    try {
      if (stop.stop_requested())
        throw Error(ErrorKind::kCancelled, sources[i].path.string(), "stopped before it");
      clip.run(
          sources[i],
          [&](bool surveying, std::uint32_t frames, std::uint32_t claimed) {
            at.surveying = surveying;
            at.frames = frames;
            at.claimed_frames = claimed;
            notify();
          },
          [&](ClipReport row) {
            report.clips.push_back(std::move(row));
            at.finished = &report.clips.back();
            notify();
            at.finished = nullptr;
          },
          stop);
    } catch (const Error& error) {
      report.stopped = error;
      return report;
    }
  }
  return report;
}

}  // namespace

IngestReport ingest(store::Store& store, const vision::Settings& settings, std::span<const fs::path> paths,
                    const IngestOptions& options, const std::function<void(const IngestProgress&)>& progress,
                    std::stop_token stop) {
  ClipIngest clip(store, settings, options);
  return run_all(clip, paths, options.shard, progress, stop);
}

IngestReport preview(const store::Store* store, const vision::Settings& settings,
                     std::span<const fs::path> paths, const IngestOptions& options,
                     const std::function<void(const IngestProgress&)>& progress, std::stop_token stop) {
  ClipIngest clip(store, settings, options);
  return run_all(clip, paths, options.shard, progress, stop);
}

}  // namespace freshet::ingest
