// bench/scale/scaled_store.h — stores of any size without more footage: jittered copies of real clips.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "bench/scale/jittered_clip.h"
#include "store/store.h"

namespace freshet::bench {

struct ScaleOptions {
  std::uint64_t patches = 246'477;  // exactly; rows of the last clip are left out to meet it
  std::uint64_t seed = 1;
  cv::Size window{640, 480};  // px: what the paper's clips measure
  int frames = 5;             // a clip: the minimum that a loop rule can be given for
  Jitter jitter{};
  std::vector<std::string> clips{};  // of the source, by name; empty: all that have patches
};

/// Gives copies in order until their patches are as many as asked for; the last one's rows are cut to fit.
///
/// Every source clip takes part as often as windows fit into its frame: large clips weigh as they do in the
/// source. The order is drawn anew for every round over all of them. So a store's first clips are those of a
/// smaller one with the same seed. Copies in which nothing moves are passed over.
///
/// take     called from the calling thread, with the clip and how many patches were given before it.
/// Throws   Error{kNotFound} when the source has no such clip, no patch or no index.
/// Memory   20 MB per source clip of 1280 x 720 and 10 MB per copy in hand (eight a time).
void generate(const store::Snapshot& source, const ScaleOptions& options,
              const std::function<void(JitteredClip&&, std::uint64_t)>& take);

struct ScaleReport {
  std::size_t clips = 0;
  std::uint64_t patches = 0, bytes = 0;
  double seconds = 0;  // wall clock
};

/// Writes what generate() gives to a new store with the source's settings and codebook, words included: it is
/// searched, labelled, verified and animated as any other. It has only a few frames per clip, in grey;
/// spectra and textureness stand for the source's whole length.
/// progress   may be empty; patches written so far.
/// Throws     as Store::create and generate.
ScaleReport write_scaled_store(const store::Snapshot& source, const std::filesystem::path& path,
                               const ScaleOptions& options,
                               const std::function<void(std::uint64_t)>& progress = {});

}  // namespace freshet::bench
