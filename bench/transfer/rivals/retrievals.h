// transfer/rivals/retrievals.h — which source patch each target patch gets, by methods that LazyFluids is beside.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/transfer/retrieval.h"

namespace freshet::bench {

/// Places of an exemplar level, and by place the most alike other one, more than a patch away; -1: none.
///
/// sources  places, in the order of Segments.
/// Source   k-coherence with k = 2 (Han et al. 2006): a patch itself and this one.
std::vector<std::int32_t> most_alike(const synth::transfer::PatchDistance& to_itself,
                                     const std::vector<int>& sources, cv::Size size, int patch, int passes,
                                     std::uint64_t seed);

/// Of the sources that the patches around a target have, moved along, and of what is most alike to them, the nearest.
/// A target with none in its task takes the nearest of all.
///
/// Others as assign_nearest.
/// Source   Han et al. 2006, "Fast Example-based Surface Texture Synthesis via Discrete Optimization".
void assign_coherent(const synth::transfer::PatchDistance& distance, const std::vector<int>& sources,
                     const std::vector<int>& targets, const std::vector<std::int32_t>& alike, int patch,
                     const synth::transfer::RetrievalOptions& options, synth::transfer::NearestField& field);

/// Twice the share of the targets that uniform use gives a source, rounded up.
inline std::int64_t most_uses(std::size_t sources, std::size_t targets) {
  return static_cast<std::int64_t>((2 * targets + sources - 1) / sources);
}

/// The nearest source that fewer than most_uses() have. Pairs are closed in order of distance, and those left over
/// search again among what is open.
/// Source   occurrence maps, Kaspar et al. 2015, "Self Tuning Texture Optimization", as LazyFluids Sec. 3.1 has them:
///          patches that are used more than twice the uniform level are rejected.
void assign_limited(const synth::transfer::PatchDistance& distance, const std::vector<int>& sources,
                    const std::vector<int>& targets, const synth::transfer::RetrievalOptions& options,
                    synth::transfer::NearestField& field);

/// The nearest source, where one that `field` uses more often than its uniform share is as many times as far.
/// Source   offset histograms (Kopf et al. 2007; Chen and Wang 2010): Benard et al. 2013 use them (LazyFluids Sec. 5).
void assign_by_histogram(const synth::transfer::PatchDistance& distance, const std::vector<int>& sources,
                         const std::vector<int>& targets, const synth::transfer::RetrievalOptions& options,
                         synth::transfer::NearestField& field);

/// The target that is nearest to each source, added to `pairs`: completeness (LazyFluids Eq. 4).
struct Completing {
  std::int32_t source, target;
  float weight;  // as so many targets' patches
};
void add_completing(const synth::transfer::PatchDistance& distance, const std::vector<int>& sources,
                    const std::vector<int>& targets, const synth::transfer::RetrievalOptions& options,
                    const synth::transfer::NearestField& sizes, double vote_power,
                    std::vector<Completing>& pairs);

}  // namespace freshet::bench
