// include/freshet/sample.h — videos of patches out of a store, drawn by chance.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "freshet/store.h"

namespace freshet {

struct SamplerOptions {
  /// Another seed, another order and other moments.
  std::uint64_t seed = 1;
  /// Length of a video, at least 1. Patches of shorter clips are left out.
  int frames = 96;
  /// Only clips of this class; empty: all.
  std::string class_name{};
  /// CV_8UC3 BGR, or without it CV_8U luminance, which is read about twice as fast.
  bool colour = true;
  /// This part of `shards` parts: they share nothing and are together what one would be.
  std::size_t shard = 0, shards = 1;
};

/// Where a drawn video comes from.
struct SampledPatch {
  std::string clip;
  std::uint64_t patch = 0;  // row of the clip's columns
  std::uint32_t first = 0;  // frame
};

/// Every patch of a store once, in an order of its own, each at a moment of its own. Same store, seed and numbers, same
/// videos: for any number of threads. Needs no index. Holds the store; safe from many threads.
class Sampler {
 public:
  /// Throws Error{kNotFound} when no patch is left, Error{kUsage} for an option out of range.
  explicit Sampler(const Store& store, const SamplerOptions& options = {});
  Sampler(const Sampler&) = default;  // and no moves: they would leave an empty one
  Sampler& operator=(const Sampler&) = default;

  /// Of this shard.
  std::size_t size() const;
  /// px, of the square videos.
  int side() const;
  /// Throws Error{kUsage} beyond size(), here and below.
  SampledPatch at(std::size_t i) const;
  /// Videos [first, first + count): count x frames x side x side, as their variants show them (footage.h, variants).
  /// Throws Error{kDamaged}, Error{kCancelled}. All threads.
  cv::Mat read(std::size_t first, std::size_t count, const Job& job = {}) const;

  /// For the library's own use.
  struct Impl;

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace freshet
