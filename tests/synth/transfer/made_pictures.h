// tests/synth/transfer/made_pictures.h — a source and a target whose patches are to be paired.
#pragma once

#include <vector>

#include "synth/transfer/features.h"
#include "synth/transfer/retrieval.h"
#include "synth/transfer/segments.h"

namespace freshet::synth::transfer {

/// Two blots: each patch of one is to get a patch of the other.
struct MadePictures {
  Features source, target;
  Segments from, to;
  std::vector<float> lambda;

  MadePictures(cv::Size source_size, cv::Size target_size, std::uint64_t seed);
  NearestField field() const { return {source.width, source.height, target.width, target.height}; }
  PatchDistance distance() const { return {source, target, lambda, 5}; }
};

/// Every source is used K or K + 1 times, R of them K + 1, and no other place is a source.
void expect_uniform(const NearestField& field, const std::vector<int>& sources,
                    const std::vector<int>& targets);

}  // namespace freshet::synth::transfer
