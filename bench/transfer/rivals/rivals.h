// transfer/rivals/rivals.h — other methods that give a designed motion the look of an exemplar.
#pragma once

#include <functional>
#include <vector>

#include "synth/transfer/transfer.h"

namespace freshet::bench {

/// LazyFluids Fig. 2 and 13. The texts of these papers were not at hand: this is what LazyFluids says of them and what
/// is known of their methods. All but kBrowning are Kwatra et al. 2005 as synth::transfer has it (Retrieval::kNearest,
/// vote_power .6: channels, levels, rounds and segments of LazyFluids), with one step changed.
enum class Rival {
  kDiscrete,       // Han et al. 2006: k-coherent search, and pixels of the exemplar for means
  kBidirectional,  // Simakov et al. 2008: each source patch also votes where it fits best
  kOccurrences,    // Kaspar et al. 2015: no source more than twice as often as its share
  /// Benard et al. 2013: image analogies with blurred alpha as guide, the frame before carried along the flow, and a
  /// histogram of offsets; no segments. Not as there: one sweep forward, where they go to and fro, and no term for
  /// distances or orientation.
  kBenard,
  /// Browning et al. 2014: keyframes, as LazyFluids made them for it: each kKeyStep-th frame by Transfer, lambda 0.
  /// Between two both are carried along the flow and blended by time; patches of both, that look like the blend,
  /// give it back its detail (regenerative morphing). Not as there: two levels, no keyframes of a person.
  kBrowning,
};
inline constexpr std::size_t kKeyStep = 10;

/// Makes the frames of `design`, in order from 0: of TransferredFrame `bgra`, and of all but kBrowning `nearest`,
/// `distance` and uses. Same bytes for any number of threads.
///
/// exemplar, design  as Transfer takes them; design outlives what is returned.
/// Throws            Error as Transfer::next does.
/// Cost              1 to 3 times Transfer with Retrieval::kNearest.
std::function<synth::transfer::TransferredFrame(std::size_t t)> rival(
    Rival method, synth::transfer::Exemplar exemplar,
    const std::vector<synth::transfer::TargetFrame>& design);

/// Where what is at p in frame t of a design was in frame `at`, or will be: CV_32FC2, px. Steps of one frame.
cv::Mat carried_places(const std::vector<synth::transfer::TargetFrame>& design, std::size_t t,
                       std::size_t at);

}  // namespace freshet::bench
