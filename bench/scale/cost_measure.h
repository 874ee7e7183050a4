// bench/scale/cost_measure.h — what one store costs: bytes, opening, searching, memory, labelling.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/harness/picture_argument.h"

namespace freshet::bench {

/// What of a store is measured. Each wants a process of its own: memory that one of them has used counts in
/// the next one's peak.
enum class Measurement {
  kOpen,    // from nothing to the candidates of the first picture: "seconds" by phase, "memory"
  kSearch,  // "median_ms" and "p99_ms" a piece on one thread, "batch_s" of kPiecesPerBatch on all; "memory"
  kLabel,   // the first picture labelled, opening aside: "seconds" by stage
  kKeep,    // "bytes" by part; "usage_s" to list and "verify_s" to read all of them; "clips", "patches"
  kIndex,   // "sample", "train", "assign", "write": `freshet index --rebuild`, which writes to the store
};
inline constexpr std::size_t kPiecesPerBatch = 500;

/// "open", "search", ...; Error{kUsage} for another.
Measurement parse_measurement(const std::string& name);

/// pictures   as a command line names them; the first is brought to 640 x 480 px (its middle, of that shape)
///            for kOpen and kLabel; pieces of all are taken evenly for kSearch.
nlohmann::json measure(const std::filesystem::path& store, Measurement what,
                       const std::vector<std::string>& pictures);

}  // namespace freshet::bench
