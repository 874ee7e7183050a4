// stored/store_settings.h — the settings that a store was made with.
#pragma once

#include "store/store.h"
#include "vision/settings.h"

namespace freshet::stored {

/// Throws Error{kDamaged} naming the store: they are not JSON, or a field is missing or out of range.
vision::Settings settings_of(const store::Snapshot& snapshot);

}  // namespace freshet::stored
