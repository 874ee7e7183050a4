// transfer/rivals/votes.h — a picture from overlapping patches, by methods that LazyFluids is beside.
#pragma once

#include <vector>

#include "bench/transfer/rivals/retrievals.h"
#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/retrieval.h"

namespace freshet::bench {

/// Each pixel becomes that one of the exemplar's pixels which the patches over it propose that is nearest to the
/// weighted mean of all of them.
///
/// Arguments as vote().
/// Source  Han et al. 2006: pixels of the exemplar for the least squares of Kwatra et al. 2005.
void vote_discrete(const synth::transfer::PixelGrid& source, const synth::transfer::NearestField& field,
                   int patch, double power, synth::transfer::PixelGrid& into);

/// The mean of vote(), to which each of `pairs` adds its source patch.
/// Source  Simakov et al. 2008, "Summarizing Visual Data Using Bidirectional Similarity", Sec. 3.
void vote_bidirectional(const synth::transfer::PixelGrid& source, const synth::transfer::NearestField& field,
                        const std::vector<Completing>& pairs, int patch, double power,
                        synth::transfer::PixelGrid& into);

}  // namespace freshet::bench
