// synth/transfer/retrieval.h — which source patch each target patch gets.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "synth/transfer/features.h"
#include "synth/transfer/segments.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// The source patch of every target patch, by place; -1 where there is none.
struct NearestField {
  int source_width = 0, source_height = 0, target_width = 0, target_height = 0;
  std::vector<std::int32_t> source;  // by target place
  std::vector<float> distance;

  NearestField() = default;
  NearestField(int source_w, int source_h, int target_w, int target_h)
      : source_width(source_w),
        source_height(source_h),
        target_width(target_w),
        target_height(target_h),
        source(static_cast<std::size_t>(target_w) * static_cast<std::size_t>(target_h), -1),
        distance(source.size(), 0.0f) {}
  std::size_t source_places() const {
    return static_cast<std::size_t>(source_width) * static_cast<std::size_t>(source_height);
  }
};

struct RetrievalOptions {
  Search search = Search::kPatchMatch;
  int passes = 4;
  std::uint64_t seed = 1;
  /// Empty, or by target place a source to try beside what the field says; -1: none.
  std::span<const std::int32_t> hints = {};
};

struct RetrievalSeconds {
  double search = 0, assign = 0;
};

/// Uniform patch use, Eq. 5. Of few pairs (kFewPairs, the coarsest level), and for Search::kExact of any, the
/// reversed retrieval of Sec. 4.1. Rounds go on until all targets have a source:
///   Every source patch looks for its nearest unassigned target patch.
///   Of those that found the same one the nearest keeps it.
///   The pairs, in order of distance, are assigned where the source has been used fewer than K times, or K
///   times while R lasts.
/// Every source is then used K or K + 1 times, R of them K + 1. Of more pairs UniformField, which has the same
/// end by exchanges: with PatchMatch for the rounds a frame of fire took eleven times as long.
///
/// sources, targets  places, in the order of Segments. sources is not empty.
/// field      what it says of the targets is where the search begins (-1: nowhere); overwritten.
///            Other places are left alone.
/// Throws  Error{kUsage} when the exact search would need more than kMaxPairs.
void assign_uniformly(const PatchDistance& distance, const std::vector<int>& sources,
                      const std::vector<int>& targets, const RetrievalOptions& options, NearestField& field,
                      RetrievalSeconds& seconds);

/// The nearest source of every target, however often it is used: Kwatra et al. 2005, Eq. 2. Else as above.
void assign_nearest(const PatchDistance& distance, const std::vector<int>& sources,
                    const std::vector<int>& targets, const RetrievalOptions& options, NearestField& field,
                    RetrievalSeconds& seconds);

inline constexpr std::int64_t kFewPairs = 1 << 20;
inline constexpr std::int64_t kFewUses = 8;  // of a source: so many rounds
inline constexpr std::int64_t kMaxPairs = std::int64_t{1} << 28;

}  // namespace freshet::synth::transfer
