// include/freshet/ingest.h — clips into a store.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "freshet/error.h"
#include "freshet/job.h"

namespace freshet {

struct IngestOptions {
  /// Class of all clips; empty: the name of the folder that each lies in.
  std::string class_name{};
  /// Licence of all clips, free text; kept with every use of them.
  std::string licence{};
  /// Take each clip whole, also where screening refuses it (moving camera, cuts, too short).
  bool force = false;
};

enum class IngestOutcome {
  kAdded,
  kAlreadyThere,
  kRefused,  // by screening
  kFailed,   // cannot be kept: no video, no patch, its name is taken, ...
};

/// A clip, or a part of one: a film of several takes becomes a clip for each, as do the stretches of a take in which
/// the camera stands. What is left out of such a film is a row too, refused.
struct IngestedClip {
  std::string name;  // of a part: "NAME@START-END", in seconds
  IngestOutcome outcome = IngestOutcome::kFailed;
  std::vector<std::string> reasons;  // sentences: why it was not added; with force, what was overridden
  std::uint32_t frames = 0;
  std::uint64_t patches = 0;
};

struct IngestReport {
  std::vector<IngestedClip> clips;  // fewer than there are when stopped
  std::optional<Error> stopped;     // cancelled, disk full, ...: what ended the run early
};

/// Adds all clips that the paths hold (videos, or folders of them, searched to any depth) to a store, which is
/// made where there is none, and brings its index up to date, so that it can be searched. Each clip is one
/// transaction; a run that was stopped is simply run again. A store that was made and got no clip is removed.
/// Throws  Error{kInput} when a path does not exist or there is no clip at all, Error{kIo} when another process
///         is writing; Error{kCancelled} when stopped while indexing, with the clips kept.
/// Cost    on two cores some 14 frames per second of 1280 x 720. The same store digest for any number of
///         threads and any order of the paths.
IngestReport add_clips(const std::filesystem::path& store, std::span<const std::filesystem::path> paths,
                       const IngestOptions& options = {}, const Job& job = {});

}  // namespace freshet
