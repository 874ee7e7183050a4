// tests/faults/aimed_damage.h — damage that knows LMDB's layout: numbers, pointers and records of a store exchanged,
// lost, or as they were in the past, so that much of it looks whole.
#pragma once

#include <random>
#include <span>

#include "tests/faults/lmdb_file.h"

namespace freshet::tools {

/// What damage is drawn from.
struct DamagedStores {
  LmdbFile whole;              // which is damaged
  std::vector<LmdbFile> past;  // the same store, earlier
  LmdbFile other;              // a store of the same clips
};

/// One file being damaged.
struct Aim {
  const DamagedStores& stores;
  std::mt19937& random;
  std::string bytes;  // begins as the whole store's
  std::string what;   // was done, for a person
};

struct AimedDamage {
  const char* kind;
  /// Damages aim.bytes; leaves them as they are where what was drawn cannot be done.
  void (*apply)(Aim& aim);
  /// Meta pages are among what it changes: LMDB then sees the state before, whole, and cannot know better.
  bool may_roll_back = false;
};

/// All kinds, in a fixed order.
std::span<const AimedDamage> aimed_damages();

}  // namespace freshet::tools
