// synth/transfer/patch_match.h — nearest neighbours among the patches of a mask, by propagation and chance.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "platform/random.h"
#include "synth/transfer/open_places.h"
#include "synth/transfer/segments.h"

namespace freshet::synth::transfer {

inline constexpr float kNoDistance = std::numeric_limits<float>::infinity();

/// A place of the other picture, and how far from it. Ordered by distance, ties by place.
struct Match {
  float distance = kNoDistance;
  std::int32_t to = -1;

  bool operator<(const Match& other) const {
    return distance < other.distance || (distance == other.distance && to < other.to);
  }
};

/// For places of one picture (from), the places of another (to) that are the nearest found so far, kKept of
/// them: when the nearest is closed, the next one is at hand. With the same two passes a round, one kept
/// found pairs of 1.26 times the exact search's sum of distances, eight 1.17 (three pairs of pictures).
struct MatchField {
  static constexpr std::size_t kKept = 8;

  int from_width = 0, from_height = 0, to_width = 0, to_height = 0;
  /// By place of from: the nearest as it was after the last search, closed meanwhile or not, for neighbours
  /// to begin at; -1: none yet.
  std::vector<std::int32_t> last;
  std::vector<Match> kept;  // kKept a place, in order

  MatchField(int from_w, int from_h, int to_w, int to_h)
      : from_width(from_w),
        from_height(from_h),
        to_width(to_w),
        to_height(to_h),
        last(static_cast<std::size_t>(from_w) * static_cast<std::size_t>(from_h), -1),
        kept(last.size() * kKept) {}

  const Match& nearest(int from) const { return kept[static_cast<std::size_t>(from) * kKept]; }
};

/// One pass over places, which are in the order of Segments: forward on even passes, backward on odd ones.
/// Each place tries its neighbours' matches moved along, then places at random in squares around its best
/// that shrink from the whole picture. A tile reads its own values as they become, those of other tiles as
/// they were before the pass: tiles may run on any thread, in any order.
///
/// cost(from, to)           the distance.
/// first(from, try_place)   calls try_place(to) with what the caller knows better.
/// seen                     scratch, as large as match.last.
/// Ties go to the lower index.
/// Source   Barnes et al. 2009, 2010.
template <class Cost, class First>
void patch_match_pass(std::span<const int> places, const OpenPlaces& open, int pass, std::uint64_t seed,
                      const Cost& cost, const First& first, MatchField& match,
                      std::vector<std::int32_t>& seen) {
  // Only what is beside a place is read from `seen`.
  for (const int place : places) {
    for (const int beside : {place - match.from_width, place - 1, place, place + 1, place + match.from_width})
      if (beside >= 0 && beside < static_cast<int>(match.last.size()))
        seen[static_cast<std::size_t>(beside)] = match.last[static_cast<std::size_t>(beside)];
  }
  std::vector<std::size_t> starts;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (i == 0 || tile_of(places[i], match.from_width) != tile_of(places[i - 1], match.from_width))
      starts.push_back(i);
  starts.push_back(places.size());
  const int step = pass % 2 == 0 ? -1 : 1;
  const Random random(seed, static_cast<std::uint64_t>(pass));

  const auto search = [&](int from, int tile) {
    Match* const kept = match.kept.data() + static_cast<std::size_t>(from) * MatchField::kKept;
    std::size_t still = 0;
    for (std::size_t k = 0; k < MatchField::kKept; ++k)
      if (kept[k].to >= 0 && open.has(kept[k].to)) kept[still++] = kept[k];
    std::fill(kept + still, kept + MatchField::kKept, Match{});
    const auto try_place = [&](std::int32_t to) {
      for (std::size_t k = 0; k < still; ++k)
        if (kept[k].to == to) return;
      const Match found{cost(from, to), to};
      if (still == MatchField::kKept && !(found < kept[still - 1])) return;
      std::size_t k = still < MatchField::kKept ? still++ : still - 1;
      for (; k > 0 && found < kept[k - 1]; --k) kept[k] = kept[k - 1];
      kept[k] = found;
    };
    first(from, try_place);
    std::uint64_t bits = random.bits(static_cast<std::uint64_t>(from));
    for (const int way : {1, match.from_width}) {
      const int beside = from + step * way;
      if (beside < 0 || beside >= static_cast<int>(match.last.size())) continue;
      const std::size_t at = static_cast<std::size_t>(beside);
      const std::int32_t of_beside = tile_of(beside, match.from_width) == tile ? match.last[at] : seen[at];
      if (of_beside < 0) continue;
      const std::int32_t moved = of_beside - step * (way == 1 ? 1 : match.to_width);
      if (moved < 0 || moved >= match.to_width * match.to_height) continue;
      const int near = open.near(moved % match.to_width, moved / match.to_width, bits);
      if (near >= 0) try_place(near);
    }
    const std::int32_t centre = still > 0 ? kept[0].to : match.last[static_cast<std::size_t>(from)];
    const int x = centre >= 0 ? centre % match.to_width : match.to_width / 2;
    const int y = centre >= 0 ? centre / match.to_width : match.to_height / 2;
    const int side = match.to_width > match.to_height ? match.to_width : match.to_height;
    for (int reach = side; reach >= 1; reach /= 2) {
      const std::uint32_t span = 2 * static_cast<std::uint32_t>(reach) + 1;
      const int dx = static_cast<int>((bits & 0xffffffffu) * span >> 32) - reach;
      const int dy = static_cast<int>((bits >> 32) * span >> 32) - reach;
      bits = scramble(bits);
      const int drawn = open.near(x + dx, y + dy, bits);
      if (drawn >= 0) try_place(drawn);
    }
    match.last[static_cast<std::size_t>(from)] = kept[0].to;
  };

  oneapi::tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t k) {
    const int tile = tile_of(places[starts[k]], match.from_width);
    if (step < 0)
      for (std::size_t i = starts[k]; i < starts[k + 1]; ++i) search(places[i], tile);
    else
      for (std::size_t i = starts[k + 1]; i-- > starts[k];) search(places[i], tile);
  });
}

}  // namespace freshet::synth::transfer
