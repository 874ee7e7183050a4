// tests/tools/sample.h — simulated clips and their store, made once per process by the executable itself.
#pragma once

#include <filesystem>

#include "tests/tools/work_folder.h"

namespace freshet::tools {

/// 192 x 144 px, 25 frames/s. Waterfalls go down, the river goes to the right or left.
struct Sample {
  std::filesystem::path clips;         // fall/1.mkv, fall/2.mkv: 32 frames each; river/1.mkv: 40 frames
  std::filesystem::path store;         // with all of them, and an index; not to be written to
  std::filesystem::path still, matte;  // of another waterfall
};

inline constexpr int kWidth = 192, kHeight = 144;
inline constexpr int kFrames = 32;  // of the waterfalls
inline constexpr int kRiverFrames = 40;

const Sample& sample();
/// Of the sample's store.
const std::string& sample_digest();

/// A copy of the sample's store that a test may spoil.
std::filesystem::path copy_of_store(const WorkFolder& folder, const std::string& name = "copy.store");

}  // namespace freshet::tools
