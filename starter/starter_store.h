// starter/starter_store.h — the store that Freshet makes itself, for who has no clips.
#pragma once

#include <filesystem>

#include "freshet/job.h"
#include "starter/recipe.h"

namespace freshet::starter {

/// A store of the recipe's clips, with its index. Same digest on every machine, for any number of threads and any width
/// of vectors. Made beside `file` and renamed: what was interrupted is begun anew. Where two processes want the same
/// file, one makes it and the other waits.
///
/// False   the file was there, or another process has made it: nothing was done.
/// OpenCV works without the processor's wider instructions meanwhile, in the whole process.
/// job     stages "making the starter store", in frames, and "waiting for another process that makes the starter
///         store".
/// Throws  Error{kIo} naming file or folder, Error{kCancelled}.
/// Cost    of own_recipe(): docs/measurements/starter.md. Beside the store, one uncompressed clip.
bool make_store(const std::filesystem::path& file, const Recipe& recipe, const Job& job = {});

/// Where the store of a recipe lies in a cache: its name holds the recipe's hash.
std::filesystem::path kept_name(const std::filesystem::path& folder, const Recipe& recipe);

}  // namespace freshet::starter
