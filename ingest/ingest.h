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
#include "ingest/screening.h"
#include "ingest/source_list.h"
#include "media/frame/repair.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::ingest {

struct IngestOptions {
  std::string class_name{};    // of all clips; empty: the folder that each lies in
  std::string licence{};       // of all clips; free text
  bool force = false;          // keep what screening refuses
  bool skip_existing = false;  // pass over clips whose name is in the store without reading their bytes
  Shard shard{};
  ScreeningLimits limits{};
  media::Repairs repairs{};  // of all clips; frames are then not the decoder's own, and "repairs" says so
};

enum class Outcome {
  kAdded,
  kAlreadyThere,  // its bytes, or with skip_existing its name, are in the store
  kRefused,       // by screening; force overrides
  kFailed,        // cannot be kept: not a video, no patch, name taken, ...
};
const char* to_string(Outcome outcome);  // "added", "already there", "refused", "failed"

/// Seconds by stage, of the calling thread except `decode`, which runs beside the others, `screen`, which
/// runs beside `flow`, and `life`, which runs beside `texture`.
struct IngestSeconds {
  double hash = 0, decode = 0, screen = 0, flow = 0, motion = 0, texture = 0, life = 0, store = 0,
         patches = 0, commit = 0;
  double total = 0;  // wall clock of the whole clip
};

/// One row of the report.
struct ClipReport {
  std::string name, class_name;
  std::filesystem::path path;
  Outcome outcome = Outcome::kFailed;
  std::vector<std::string> reasons;  // sentences: why it was not added; with force, what was overridden
  std::vector<std::string> notes;    // "no static reference", "11 of 50 frames", ...
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
  std::vector<ClipReport> clips;  // one per source, in the order of the list; fewer when stopped
  std::optional<Error> stopped;   // cancelled, disk full, store damaged: what ended the run early
  std::size_t count(Outcome outcome) const;
};

/// Where a run stands.
struct IngestProgress {
  std::size_t clip = 0, clips = 0;  // index of the clip in hand; of how many
  const Source* source = nullptr;
  std::uint32_t frames = 0;              // done of the clip in hand
  std::uint32_t claimed_frames = 0;      // by its header; 0: unknown
  const ClipReport* finished = nullptr;  // set on the last call for a clip
};

/// Adds all clips that the paths hold (see list_sources) to the store, one after another, each streamed in
/// slabs of 16 frames, so that memory does not grow with a clip's length.
///
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

}  // namespace freshet::ingest
