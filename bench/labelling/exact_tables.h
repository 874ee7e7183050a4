// bench/labelling/exact_tables.h — pairwise tables pixel by pixel, with every frequency, beside pooled ones.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>

#include "bench/harness/picture_argument.h"
#include "store/store.h"

namespace freshet::bench {

/// All tables of a picture from `exact`, a store made with `ingest --cell 1 --bands 0 --flow-step 1`, and
/// from `pooled`, which must hold its clips: the same candidates, those that a search of `exact` finds.
/// memory_bytes   for the exact log features (PartsWanted).
/// Prints and returns seconds of each, ten exact tables' maximum error, and what the labels that pooled
/// tables choose cost under the exact ones. "right" is false when an error is above kErrorAllowed.
nlohmann::json measure_exact(const store::Snapshot& pooled, const store::Snapshot& exact,
                             const PictureArgument& picture, std::size_t memory_bytes);

}  // namespace freshet::bench
