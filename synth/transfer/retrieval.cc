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
void exact_rounds(const PatchDistance& distance, std::vector<int> sources, const std::vector<int>& targets,
                  Uses& uses, NearestField& field, std::vector<std::int32_t>& claims,
                  RetrievalSeconds& seconds) {
  Stopwatch watch;
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

// What a field says already: by source place, its targets, the nearest first.
class Known {
 public:
  Known(const PatchDistance& distance, const std::vector<int>& sources, const std::vector<int>& targets,
        const NearestField& field)
      : begin_(field.source_places() + 1, 0) {
    std::vector<std::uint8_t> is_source(field.source_places(), 0);
    for (const int source : sources) is_source[static_cast<std::size_t>(source)] = 1;
    const auto source_of = [&](int target) {
      const std::int32_t source = field.source[static_cast<std::size_t>(target)];
      return source >= 0 && is_source[static_cast<std::size_t>(source)] ? source : -1;
    };
    for (const int target : targets)
      if (const std::int32_t source = source_of(target); source >= 0)
        ++begin_[static_cast<std::size_t>(source)];
    std::int32_t sum = 0;
    for (std::int32_t& begin : begin_) {
      const std::int32_t count = begin;
      begin = sum;
      sum += count;
    }
    next_ = begin_;
    std::vector<std::int32_t> of(static_cast<std::size_t>(sum));
    for (const int target : targets)
      if (const std::int32_t source = source_of(target); source >= 0)
        of[static_cast<std::size_t>(next_[static_cast<std::size_t>(source)]++)] = target;
    next_ = begin_;
    targets_.resize(of.size());
    std::vector<std::uint64_t> keys(of.size());
    oneapi::tbb::parallel_for(std::size_t{0}, sources.size(), [&](std::size_t i) {
      const std::size_t source = static_cast<std::size_t>(sources[i]);
      const std::ptrdiff_t from = begin_[source], to = begin_[source + 1];
      for (std::ptrdiff_t k = from; k < to; ++k) {
        const std::int32_t target = of[static_cast<std::size_t>(k)];
        keys[static_cast<std::size_t>(k)] =
            std::uint64_t{std::bit_cast<std::uint32_t>(distance(sources[i], target))} << 32 |
            static_cast<std::uint32_t>(target);
      }
      std::sort(keys.begin() + from, keys.begin() + to);
      for (std::ptrdiff_t k = from; k < to; ++k)
        targets_[static_cast<std::size_t>(k)] = static_cast<std::int32_t>(keys[static_cast<std::size_t>(k)]);
    });
  }

  /// The nearest that is still open, or -1. A source's own: safe from many threads for different sources.
  std::int32_t next(std::int32_t source, const OpenPlaces& open) {
    std::int32_t& at = next_[static_cast<std::size_t>(source)];
    const std::int32_t end = begin_[static_cast<std::size_t>(source) + 1];
    while (at < end && !open.has(targets_[static_cast<std::size_t>(at)])) ++at;
    return at < end ? targets_[static_cast<std::size_t>(at)] : -1;
  }

 private:
  std::vector<std::int32_t> begin_, next_, targets_;
};

}  // namespace

void assign_uniformly(const PatchDistance& distance, const std::vector<int>& sources,
                      const std::vector<int>& targets, const RetrievalOptions& options, NearestField& field,
                      RetrievalSeconds& seconds) {
  assert(!sources.empty());
  if (targets.empty()) return;
  Uses uses(field.source_places(), sources.size(), targets.size());
  std::vector<std::int32_t> claims(field.source.size(), -1);
  if (options.search == Search::kExact) {
    refuse_too_many(sources.size(), targets.size());
    exact_rounds(distance, sources, targets, uses, field, claims, seconds);
    return;
  }
  Stopwatch watch;
  Known known(distance, sources, targets, field);
  OpenPlaces open(field.target_width, field.target_height, targets);
  MatchField match(field.source_width, field.source_height, field.target_width, field.target_height);
  std::vector<std::int32_t> seen(match.last.size(), -1);
  std::vector<int> active = sources;
  std::vector<Pair> pairs;
  const auto first = [&](int source, const auto& try_place) {
    if (const std::int32_t target = known.next(source, open); target >= 0) try_place(target);
  };
  int pass = 0;
  while (open.count() > 0) {
    if (pass > 0)
      active.erase(
          std::remove_if(active.begin(), active.end(), [&](int source) { return !uses.may(source); }),
          active.end());
    if (static_cast<std::int64_t>(active.size()) * open.count() <= kFewPairs) {
      std::vector<int> rest;
      for (const int target : targets)
        if (open.has(target)) rest.push_back(target);
      seconds.assign += watch.lap();
      exact_rounds(distance, active, rest, uses, field, claims, seconds);
      return;
    }
    seconds.assign += watch.lap();
    for (int left = options.passes; left > 0; --left, ++pass)
      patch_match_pass(active, open, pass, options.seed, distance, first, match, seen);
    seconds.search += watch.lap();
    pairs.clear();
    for (const int source : active) {
      const Match& nearest = match.nearest(source);
      pairs.emplace_back(nearest.distance, source, nearest.to);
    }
    settle(pairs, claims);
    for (const Pair& pair : pairs) {
      if (!uses.take(pair.source)) continue;
      field.source[static_cast<std::size_t>(pair.target)] = pair.source;
      field.distance[static_cast<std::size_t>(pair.target)] = pair.distance();
      open.remove(pair.target);
    }
  }
  seconds.assign += watch.lap();
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
  // Twice the passes: here a search is one per target, where the uniform retrieval has some three.
  for (int pass = 0; pass < 2 * options.passes; ++pass)
    patch_match_pass(targets, open, pass, options.seed, cost, first, match, seen);
  for (const int target : targets) {
    const std::size_t at = static_cast<std::size_t>(target);
    field.source[at] = match.nearest(target).to;
    field.distance[at] = match.nearest(target).distance;
  }
  seconds.search += watch.lap();
}

}  // namespace freshet::synth::transfer
