// synth/transfer/draft.h — a frame in the making, from the coarsest level to the finest.
#pragma once

#include <cstdint>
#include <vector>

#include "synth/transfer/exemplar.h"
#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/retrieval.h"
#include "synth/transfer/target_level.h"

namespace freshet::synth::transfer {

/// The picture as far as it is made, and the source patches that it is made of. Both of one level's size, with its
/// margin.
struct Draft {
  PixelGrid picture;
  NearestField field;
};

/// What the coarsest level begins from: patches of the exemplar, drawn by `seed`. They are laid out as squares side
/// by side: averages of patches that have nothing to do with each other would be one grey. Nothing is retrieved yet.
Draft random_draft(const ExemplarLevel& source, const TargetLevel& target, const TransferOptions& options,
                   std::uint64_t seed);

/// Puts the frame before where its fluid is most of what is here.
void start_from_past(const TargetLevel& target, double lambda, PixelGrid& picture);

/// The source places of the frame before where its fluid is now, for a level of the exemplar: by place of that
/// level's target, margin included; -1 where there is none.
///
/// carried  of the frame's size, places in `finest`; -1 where there is none.
/// halvings  from the finest level to this one.
std::vector<std::int32_t> carried_sources(const GridOf<std::int32_t>& carried, const ExemplarLevel& finest,
                                          const ExemplarLevel& source, int halvings, cv::Size target,
                                          int margin);

/// What the coarser level found, one level finer: patches keep their neighbours, and the picture is voted from them.
Draft refined(const Draft& coarse, const ExemplarLevel& coarse_source, const ExemplarLevel& source,
              const TargetLevel& target, const TransferOptions& options);

/// Makes transparent what no patch of `field` reaches. half: of a patch, px.
void clear_uncovered(const NearestField& field, int half, PixelGrid& picture);

/// So many of the sources: all of some tiles, and some of one more. Tiles lie spread over all of the picture, so that
/// their colours are its; a part of fewer sources is contained in one of more.
///
/// Eq. 5 leaves open which R of the sources are used K + 1 times. Left to the search, where K = 0, these are the
/// darkest and smoothest, which are near to everything: fire becomes dim and soft.
///
/// sources  places in a picture of this width, in the order of Segments.
/// count    1 to the number of sources.
/// tile     px per side; halved with the level, the same tiles come at every level.
/// seed     which tiles come first.
/// Returns  places, in the order in which they were.
std::vector<int> part_of(const std::vector<int>& sources, int width, std::size_t count, int tile,
                         std::uint64_t seed);

}  // namespace freshet::synth::transfer
