// stored/clip_loop.h — a stored clip's loop rule.
#pragma once

#include <optional>

#include "store/store.h"
#include "vision/loop_rule.h"

namespace freshet::stored {

/// The rule that ingest found, from the clip's metadata. Clips of stores made before there were rules are
/// read once and measured here, as ingest would have (a second for 200 frames of 1280 x 720). None: too
/// short. Throws Error{kDamaged} for a rule that does not fit the clip.
std::optional<vision::LoopRule> loop_rule(const store::Snapshot& snapshot, store::ClipId clip);

}  // namespace freshet::stored
