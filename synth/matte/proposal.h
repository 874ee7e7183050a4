// synth/matte/proposal.h — where a picture's fluid may be, as the store itself sees it.
#pragma once

#include <cstddef>
#include <string>

#include "query/search/candidates.h"
#include "query/search/target.h"
#include "synth/matte/marks.h"

namespace freshet::synth::matte {

struct ProposalOptions {
  int best = 10;                 // candidates of a piece whose scores are averaged
  double min_difference = 0.05;  // of mean score between fluid and background, below which nothing stands out
};

struct Proposal {
  Marks marks;  // of the target's size: the middles of sure pieces, half a piece wide
  std::size_t fluid_pieces = 0, background_pieces = 0;
  double fluid_score = 0, background_score = 0;  // means on either side of the threshold, 0..1
  bool stands_out = true;  // false: the two differ by too little, and no piece is marked
};

/// Marks the pieces whose best candidates are good. Scores are smoothed over each piece and its eight
/// neighbours and split in two where that explains most of their variance (Otsu 1979). Pieces at or above the
/// upper side's mean are fluid, at or below the lower side's mean background, the rest is left to GrabCut.
/// It is a guess: descriptors are blind to colour, and smooth sky or steel looks like a calm fluid.
///
/// target, candidates   of the whole picture.
Proposal propose_marks(const query::Target& target, const query::Candidates& candidates,
                       const ProposalOptions& options);

}  // namespace freshet::synth::matte
