#include "synth/transfer/retrieval.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/transfer/patch_match.h"
#include "synth/transfer/uniform_field.h"

namespace freshet::synth::transfer {
namespace {

void refuse_too_many(std::size_t sources, std::size_t targets) {
  if (static_cast<std::int64_t>(sources) * static_cast<std::int64_t>(targets) > kMaxPairs) {
    throw Error(ErrorKind::kUsage, "search",
                fmt::format("the exact search of {} source and {} target patches would take too long",
                            sources, targets),
                "Use PatchMatch, or smaller pictures");
  }
}

// A source and the target that it found. Ordered by distance, then by place: distances are not negative, and
// their bits are then in their order.
struct Pair {
  std::uint64_t key;
  std::int32_t source, target;

  Pair(float distance, std::int32_t s, std::int32_t t)
      : key(std::uint64_t{std::bit_cast<std::uint32_t>(distance)} << 32 | static_cast<std::uint32_t>(t)),
        source(s),
        target(t) {}
  float distance() const { return std::bit_cast<float>(static_cast<std::uint32_t>(key >> 32)); }
  bool operator<(const Pair& other) const { return key < other.key; }
};

// The state of Sec. 4.1.
class Uses {
 public:
  Uses(std::size_t places, std::size_t sources, std::size_t targets)
      : used_(places, 0),
        min_uses_(static_cast<std::int32_t>(targets / sources)),
        left_over_(static_cast<std::int64_t>(targets % sources)) {}

  bool may(std::int32_t source) const {
    const std::int32_t used = used_[static_cast<std::size_t>(source)];
    return used < min_uses_ || (used == min_uses_ && left_over_ > 0);
  }
  bool take(std::int32_t source) {
    if (!may(source)) return false;
    std::int32_t& used = used_[static_cast<std::size_t>(source)];
    if (used == min_uses_) --left_over_;
    ++used;
    return true;
  }

 private:
  std::vector<std::int32_t> used_;  // c, by source place
  std::int32_t min_uses_;           // K
  std::int64_t left_over_;          // R
};

// Of sources with the same target, the nearest is kept: `pairs` becomes what is left, in order of distance.
// claims: by target place, all -1 before and after.
void settle(std::vector<Pair>& pairs, std::vector<std::int32_t>& claims) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::int32_t& claim = claims[static_cast<std::size_t>(pairs[i].target)];
    const auto nearer = [&](const Pair& a, const Pair& b) {
      return a.key != b.key ? a.key < b.key : a.source < b.source;
    };
    if (claim < 0 || nearer(pairs[i], pairs[static_cast<std::size_t>(claim)]))
      claim = static_cast<std::int32_t>(i);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::int32_t& claim = claims[static_cast<std::size_t>(pairs[i].target)];
    if (claim != static_cast<std::int32_t>(i)) continue;
    claim = -1;
    std::swap(pairs[kept++], pairs[i]);
  }
  pairs.erase(pairs.begin() + static_cast<std::ptrdiff_t>(kept), pairs.end());
  oneapi::tbb::parallel_sort(pairs.begin(), pairs.end());
}

// The rounds with the distances of all pairs at hand.
void exact_rounds(const PatchDistance& distance, const std::vector<int>& sources,
                  const std::vector<int>& targets, NearestField& field, RetrievalSeconds& seconds) {
  Stopwatch watch;
  Uses uses(field.source_places(), sources.size(), targets.size());
  std::vector<std::int32_t> claims(field.source.size(), -1);
  const std::size_t columns = targets.size();
  std::vector<float> table(sources.size() * columns);
  oneapi::tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
    for (std::size_t k = 0; k < columns; ++k) table[i * columns + k] = distance(sources[i], targets[k]);
  });
  seconds.search += watch.lap();
  // By target place while it is open: its column. open: columns still open, in order of place.
  std::vector<std::int32_t> column_of(field.source.size(), -1), open(columns);
  for (std::size_t k = 0; k < columns; ++k) {
    column_of[static_cast<std::size_t>(targets[k])] = static_cast<std::int32_t>(k);
    open[k] = static_cast<std::int32_t>(k);
  }
  std::vector<std::int32_t> row(sources.size()), best(sources.size(), -1);
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = static_cast<std::int32_t>(i);
  std::vector<Pair> pairs;
  while (!open.empty()) {
    row.erase(std::remove_if(row.begin(), row.end(),
                             [&](std::int32_t i) { return !uses.may(sources[static_cast<std::size_t>(i)]); }),
              row.end());
    oneapi::tbb::parallel_for(std::size_t{0}, row.size(), [&](std::size_t at) {
      const std::size_t i = static_cast<std::size_t>(row[at]);
      const auto place = [&](std::int32_t k) { return targets[static_cast<std::size_t>(k)]; };
      if (best[i] >= 0 && column_of[static_cast<std::size_t>(place(best[i]))] >= 0) return;
      const float* of = table.data() + i * columns;
      std::int32_t nearest = open[0];
      for (const std::int32_t k : open)
        if (of[k] < of[nearest] || (of[k] == of[nearest] && place(k) < place(nearest))) nearest = k;
      best[i] = nearest;
    });
    seconds.search += watch.lap();
    pairs.clear();
    for (const std::int32_t i : row) {
      const std::size_t at = static_cast<std::size_t>(i), column = static_cast<std::size_t>(best[at]);
      pairs.emplace_back(table[at * columns + column], sources[at], targets[column]);
    }
    settle(pairs, claims);
    for (const Pair& pair : pairs) {
      if (!uses.take(pair.source)) continue;
      field.source[static_cast<std::size_t>(pair.target)] = pair.source;
      field.distance[static_cast<std::size_t>(pair.target)] = pair.distance();
      column_of[static_cast<std::size_t>(pair.target)] = -1;
    }
    open.erase(
        std::remove_if(open.begin(), open.end(),
                       [&](std::int32_t k) {
                         return column_of[static_cast<std::size_t>(targets[static_cast<std::size_t>(k)])] < 0;
                       }),
        open.end());
    seconds.assign += watch.lap();
  }
}

}  // namespace

void assign_uniformly(const PatchDistance& distance, const std::vector<int>& sources,
                      const std::vector<int>& targets, const RetrievalOptions& options, NearestField& field,
                      RetrievalSeconds& seconds) {
  assert(!sources.empty());
  if (targets.empty()) return;
  const auto from = static_cast<std::int64_t>(sources.size()), to = static_cast<std::int64_t>(targets.size());
  if (options.search == Search::kExact || (from * to <= kFewPairs && to <= kFewUses * from)) {
    refuse_too_many(sources.size(), targets.size());
    exact_rounds(distance, sources, targets, field, seconds);
    return;
  }
  Stopwatch watch;
  UniformField uniform(distance, sources, targets, options.seed, field);
  seconds.assign += watch.lap();
  for (int pass = 0; pass < options.passes; ++pass)
    uniform.exchange(pass, pass == 0 ? options.hints : std::span<const std::int32_t>());
  seconds.search += watch.lap();
}

void assign_nearest(const PatchDistance& distance, const std::vector<int>& sources,
                    const std::vector<int>& targets, const RetrievalOptions& options, NearestField& field,
                    RetrievalSeconds& seconds) {
  assert(!sources.empty());
  Stopwatch watch;
  if (options.search == Search::kExact) {
    refuse_too_many(sources.size(), targets.size());
    oneapi::tbb::parallel_for(std::size_t{0}, targets.size(), [&](std::size_t i) {
      const std::size_t at = static_cast<std::size_t>(targets[i]);
      field.source[at] = -1;
      for (const int source : sources) {
        const float d = distance(source, targets[i]);
        if (field.source[at] >= 0 &&
            !(d < field.distance[at] || (d == field.distance[at] && source < field.source[at])))
          continue;
        field.source[at] = source;
        field.distance[at] = d;
      }
    });
    seconds.search += watch.lap();
    return;
  }
  const OpenPlaces open(field.source_width, field.source_height, sources);
  MatchField match(field.target_width, field.target_height, field.source_width, field.source_height);
  std::vector<std::int32_t> seen(match.last.size(), -1);
  const auto cost = [&](int target, int source) { return distance(source, target); };
  const auto first = [&](int target, const auto& try_place) {
    const std::int32_t source = field.source[static_cast<std::size_t>(target)];
    if (source >= 0 && open.has(source)) try_place(source);
  };
  for (int pass = 0; pass < options.passes; ++pass)
    patch_match_pass(targets, open, pass, options.seed, cost, first, match, seen);
  for (const int target : targets) {
    const std::size_t at = static_cast<std::size_t>(target);
    field.source[at] = match.nearest(target).to;
    field.distance[at] = match.nearest(target).distance;
  }
  seconds.search += watch.lap();
}

}  // namespace freshet::synth::transfer
