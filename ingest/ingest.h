// ingest.h — clips into a store: frames, flow, average, columns; one transaction per clip.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "freshet/error.h"
#include "ingest/alike_clips.h"
#include "ingest/clip_sources.h"
#include "ingest/screening.h"
#include "ingest/source_list.h"
#include "ingest/survey.h"
#include "media/frame/repair.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::ingest {

struct IngestOptions {
  std::string class_name{};  // of all clips; empty: the folder that each lies in
  std::string licence{};     // of all clips of which `sources` says none; free text
  std::vector<ClipSource> sources{};
  bool force = false;          // keep what screening refuses
  bool pictures = false;       // each row gets its look
  bool steady = false;         // what a moving camera filmed is made steady (steady.h); not with force
  bool skip_existing = false;  // pass over clips whose name is in the store without reading their bytes
  Shard shard{};
  ScreeningLimits limits{};
  media::Repairs repairs{};  // of all clips; frames are then not the decoder's own, and "repairs" says so
};

enum class Outcome {
  kAdded,
  kWouldAdd,      // by preview
  kAlreadyThere,  // its bytes, or with skip_existing its name, are in the store
  kRefused,       // by screening; force overrides
  kFailed,        // cannot be kept: not a video, no patch, name taken, ...
};
const char* to_string(Outcome outcome);  // "added", "would be added", "already there", "refused", "failed"

/// Seconds by stage, of the calling thread except `decode`, which runs beside the others, `screen`, which
/// runs beside `flow`, and `life`, which runs beside `texture`.
struct IngestSeconds {
  double hash = 0, survey = 0, decode = 0, screen = 0, flow = 0, motion = 0, texture = 0, life = 0, store = 0,
         patches = 0, commit = 0;
  double total = 0;  // wall clock of the whole clip
};

/// One row of the report: a source, or a part of one, that is a clip or was left out.
struct ClipReport {
  std::string name, class_name;  // of a part: part_name
  std::filesystem::path path;
  std::optional<Span> part;  // of a source that is taken in parts
  double steadied_kept = 0;  // share of its frames' area, where they were made steady
  Outcome outcome = Outcome::kFailed;
  std::vector<std::string> reasons;  // sentences: why it was not added; with force, what was overridden
  std::vector<std::string> notes;    // "no static reference", "11 of 50 frames", ...
  std::vector<std::string> help;     // what would help against a refusal
  std::optional<AlikeClip> alike;    // a near-duplicate of it; not looked for with force
  PartLook look;                     // with IngestOptions::pictures
  std::uint32_t frames = 0;          // decoded
  std::uint32_t width = 0, height = 0;
  double fps = 0;
  std::uint64_t patches = 0;
  std::vector<std::uint64_t> patches_by_variant;
  Screening screening;
  IngestSeconds seconds;
  // By which the store's file grew. Free pages, and those that a dropped clip left behind, are used first.
  std::uint64_t stored_bytes = 0;
};

struct IngestReport {
  std::vector<ClipReport> clips;  // a source after another, in the order of the list; fewer when stopped
  std::optional<Error> stopped;   // cancelled, disk full, store damaged: what ended the run early
  std::size_t count(Outcome outcome) const;
};

/// Where a run stands.
struct IngestProgress {
  std::size_t clip = 0, clips = 0;  // index of the clip in hand; of how many
  const Source* source = nullptr;
  std::uint32_t frames = 0;              // done of the clip in hand
  std::uint32_t claimed_frames = 0;      // by its header; 0: unknown
  bool surveying = false;                // at the first look; the frames are then counted again
  const ClipReport* finished = nullptr;  // set on a call of its own for each row
};

/// Adds all clips that the paths hold (see list_sources) to the store, one after another, each streamed in
/// slabs of 16 frames, so that memory does not grow with a clip's length.
///
/// Parts     Each source is looked at first (survey.h), unless force takes it as it is. One that is not fit as a
///           whole, but in parts, becomes a clip for each of these: named part_name, with the hash part_hash, times
///           that begin with 0, and where it lies in its source under "part" in its metadata. What is left out is a
///           row too, refused.
/// Streams   kFrames: native planes.
///           kFlow: u, v at 1 / settings.flow_step, frame t from t to t + 1, one frame fewer than the clip.
///           kAverage: one plane of 16 bits, mean luma over 0..65535, source size.
/// Columns   stored/clip_schema.h: all but the index's.
/// Metadata  stored/clip_metadata.h: all fields, and the screening's report.
///
/// What is wrong with a clip ends up in its row, and the run goes on. What is wrong with the store or the
/// machine, and a stop request, ends the run: the clip in hand leaves no trace, those before are kept, and
/// IngestReport::stopped says why. A second run goes on where the first ended.
///
/// progress  called from the calling thread: when a clip begins, after each slab, when it ends; may be empty.
/// Throws    as list_sources, before anything is read.
/// Same store digest for any number of threads and any order of the paths.
IngestReport ingest(store::Store& store, const vision::Settings& settings,
                    std::span<const std::filesystem::path> paths, const IngestOptions& options = {},
                    const std::function<void(const IngestProgress&)>& progress = {},
                    std::stop_token stop = {});

/// What ingest would do, by the first look alone: nothing is written, and of what would be added flow and patches are
/// not known. store   null: there is none yet.
IngestReport preview(const store::Store* store, const vision::Settings& settings,
                     std::span<const std::filesystem::path> paths, const IngestOptions& options = {},
                     const std::function<void(const IngestProgress&)>& progress = {},
                     std::stop_token stop = {});

}  // namespace freshet::ingest
