// stored/clip_metadata.h — what is kept of a clip as JSON: neither samples nor columns.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "media/frame/frame.h"
#include "store/store.h"
#include "stored/clip_columns.h"
#include "vision/detail_lifetime.h"
#include "vision/loop_rule.h"

namespace freshet::stored {

/// How the rows of a column of cells lie in the frame.
struct CellShape {
  int rows = 0, columns = 0, channels = 0;
  float cell = 0;  // px of the source, side of a cell
};

struct CellShapes {
  std::optional<CellShape> motion{}, life{}, standing{}, layout{};
  std::vector<CellShape> texture{};  // a scale of the settings
};
CellShapes shapes_of(const ClipColumns& columns);

/// Fields of an optional that is empty may be missing in a store.
struct ClipMetadata {
  std::optional<media::PixelLayout> layout{};
  std::string codec{}, container{};
  bool variable_frame_rate = false;
  std::string repairs{};               // filters that changed the frames; empty: none
  std::string author{}, source{};      // whose it is, and where it came from; empty: nobody said
  std::vector<std::string> notices{};  // for a person
  CellShapes cells{};
  std::vector<std::uint64_t> patches{};  // by variant
  /// Nothing: the clip is too short to have one, or was ingested before there were rules.
  std::optional<vision::LoopRule> loop{};
  bool loop_known = true;  // false: ingested before there were rules
  /// Of the whole clip, by Laplacian band, as vision::DetailLifetimes::clip and clip_standing.
  std::optional<std::array<float, vision::kLifeBands>> half_life_s{}, standing{};
  /// Keys that no program reads: the screening's report, how a bench made the clip.
  nlohmann::json more = nlohmann::json::object();
};

std::string to_json(const ClipMetadata& metadata);

/// Reads it from a clip's record.
/// Throws Error{kDamaged} naming store and clip: it is no JSON, or a field is of another type or out of range.
ClipMetadata metadata_of(const store::Snapshot& snapshot, store::ClipId clip);

}  // namespace freshet::stored
