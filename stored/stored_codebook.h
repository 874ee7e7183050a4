// stored/stored_codebook.h — the codebook as it is kept in a store.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "store/store.h"
#include "vision/codebook.h"

namespace freshet::stored {

inline constexpr const char* kCodebookBlob = "codebook";

/// A codebook and the clips that it was trained on: its words are valid for these clips only.
struct StoredCodebook {
  vision::Codebook codebook;
  std::uint64_t clips_hash = 0;  // see hash_of_clips
};

/// XXH3-64 of the clips' source hashes in ascending order, so that it does not depend on the order of ingest.
std::uint64_t hash_of_clips(const store::Snapshot& snapshot);

/// Layout: "FRSHCBK1", u32 words, u32 descriptor size, u64 clips_hash, then words * size floats.
std::vector<std::byte> to_bytes(const StoredCodebook& stored);
/// Nothing when there is none. Throws Error{kDamaged} when its length or a number in it cannot be.
std::optional<StoredCodebook> find_codebook(const store::Snapshot& snapshot);
/// Throws Error{kNotFound} "run freshet index" when there is none, or when clips have been added since.
vision::Codebook read_codebook(const store::Snapshot& snapshot);

}  // namespace freshet::stored
