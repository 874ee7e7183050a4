// synth/flowlines/files/footage_files.h — a clip's frames from a video, a sequence or a store.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>

#include "store/store.h"
#include "synth/flowlines/footage.h"

namespace freshet::synth::flowlines {

struct FootageOptions {
  int from = 0;                                        // first frame that is taken
  int frames = 0;                                      // that are taken at most; 0: all
  std::size_t memory_bytes = std::size_t{1200} << 20;  // frames beyond are left, with a notice
};

/// A video, a folder or a pattern of pictures. Throws Error{kInput} naming the file: unreadable, of changing size,
/// fewer frames than `from`.
Footage read_footage(const std::filesystem::path& path, const FootageOptions& options = {});
/// A clip of a store. Throws Error{kNotFound} that lists some of its clips, Error{kDamaged}.
Footage read_footage(const store::Snapshot& snapshot, const std::string& clip,
                     const FootageOptions& options = {});

}  // namespace freshet::synth::flowlines
