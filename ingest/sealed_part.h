// ingest/sealed_part.h — one shard of an ingest that several machines share: made unseen, verified, and named last.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "platform/shard.h"

namespace freshet::ingest {

/// In the folder STORE.parts: I-of-N.store, absent where no clip of the shard was taken, and I-of-N.json, the report of
/// its clips, which is written last: once it is there, the shard is sealed and does not change. Machines may seal one
/// shard at once: what they make is the same.
class SealedPart {
 public:
  /// store   of which this is to be a part; the two need not exist.
  SealedPart(const std::filesystem::path& store, Shard shard);

  const std::filesystem::path& store() const { return store_; }
  /// Whether it is sealed.
  /// made_by   what decides what it holds: clips, options, settings.
  /// Throws    Error{kUsage} where it was made by something else, Error{kInput} where its report is garbled.
  bool is_sealed(const nlohmann::json& made_by) const;
  /// With "stored", and of each of its "clips" name, outcome and reasons. Throws Error{kInput} where it is garbled.
  nlohmann::json report() const;
  /// Copies the shard's store beside its place, verifies the copy, and names it; then the report, with "made_by" and
  /// the number of clips "stored".
  /// made     on this machine's own disk; not there where no clip was taken.
  /// Throws   Error{kIo}; Error{kDamaged} where the copy is not what was written.
  void seal(const std::filesystem::path& made, const nlohmann::json& made_by, nlohmann::json report) const;

 private:
  std::filesystem::path store_, report_;
};

/// The shards that were sealed of a store, all N of them.
/// Throws Error{kNotFound} when there are none, or naming those that are missing; Error{kUsage} when they are of two
/// numbers, or as SealedPart::is_sealed; Error{kDamaged} for a store that is missing or holds another number of clips
/// than its report says.
std::vector<SealedPart> sealed_parts(const std::filesystem::path& store, const nlohmann::json& made_by);

/// What killed runs have left in STORE.parts.
void remove_unsealed(const std::filesystem::path& store);

}  // namespace freshet::ingest
