#include "bench/transfer/rivals/retrievals.h"

#include <algorithm>
#include <cstdlib>
#include <tuple>

#include <oneapi/tbb/parallel_for.h>

#include "synth/transfer/patch_match.h"
#include "synth/transfer/vote.h"

namespace freshet::bench {
namespace {

using namespace synth::transfer;

// The nearest open places of another picture, for places of this one.
template <class Cost, class First>
MatchField matched(const std::vector<int>& places, cv::Size from, const OpenPlaces& open, cv::Size to,
                   int passes, std::uint64_t seed, const Cost& cost, const First& first) {
  MatchField match(from.width, from.height, to.width, to.height);
  std::vector<std::int32_t> seen(match.last.size(), -1);
  for (int pass = 0; pass < passes; ++pass)
    patch_match_pass(places, open, pass, seed, cost, first, match, seen);
  return match;
}
constexpr auto kNothingFirst = [](int, const auto&) {};

cv::Size from_size(const NearestField& field) { return {field.target_width, field.target_height}; }
cv::Size to_size(const NearestField& field) { return {field.source_width, field.source_height}; }

// What the field says is tried first.
auto as_before(const NearestField& field, const OpenPlaces& open) {
  return [&](int target, const auto& try_place) {
    const std::int32_t source = field.source[static_cast<std::size_t>(target)];
    if (source >= 0 && open.has(source)) try_place(source);
  };
}

}  // namespace

std::vector<std::int32_t> most_alike(const PatchDistance& to_itself, const std::vector<int>& sources,
                                     cv::Size size, int patch, int passes, std::uint64_t seed) {
  const OpenPlaces open(size.width, size.height, sources);
  const auto cost = [&](int from, int to) {
    const bool near = std::abs(from % size.width - to % size.width) <= patch &&
                      std::abs(from / size.width - to / size.width) <= patch;
    return near ? kNoDistance : to_itself(to, from);
  };
  const MatchField match = matched(sources, size, open, size, passes, seed, cost, kNothingFirst);
  std::vector<std::int32_t> alike(static_cast<std::size_t>(size.area()), -1);
  for (const int place : sources)
    if (const Match& found = match.nearest(place); found.distance < kNoDistance)
      alike[static_cast<std::size_t>(place)] = found.to;
  return alike;
}

void assign_coherent(const PatchDistance& distance, const std::vector<int>& sources,
                     const std::vector<int>& targets, const std::vector<std::int32_t>& alike, int patch,
                     const RetrievalOptions& options, NearestField& field) {
  const OpenPlaces open(field.source_width, field.source_height, sources);
  const std::vector<std::int32_t> had = field.source;
  const int half = patch / 2;
  oneapi::tbb::parallel_for(std::size_t{0}, targets.size(), [&](std::size_t i) {
    const int target = targets[i];
    Match best;
    // Neither picture has patches nearer to its edges than half of one: rows are not left.
    for (int dy = -half; dy <= half; ++dy)
      for (int dx = -half; dx <= half; ++dx) {
        const std::int32_t beside = had[static_cast<std::size_t>(target + dy * field.target_width + dx)];
        if (beside < 0) continue;
        for (const std::int32_t like : {beside, alike[static_cast<std::size_t>(beside)]}) {
          const std::int32_t moved = like - dy * field.source_width - dx;
          if (like >= 0 && open.has(moved)) best = std::min(best, Match{distance(moved, target), moved});
        }
      }
    field.source[static_cast<std::size_t>(target)] = best.to;
    field.distance[static_cast<std::size_t>(target)] = best.distance;
  });
  std::vector<int> lone;
  for (const int target : targets)
    if (field.source[static_cast<std::size_t>(target)] < 0) lone.push_back(target);
  RetrievalSeconds seconds;
  if (!lone.empty()) assign_nearest(distance, sources, lone, options, field, seconds);
}

void assign_limited(const PatchDistance& distance, const std::vector<int>& sources,
                    const std::vector<int>& targets, const RetrievalOptions& options, NearestField& field) {
  OpenPlaces open(field.source_width, field.source_height, sources);
  std::vector<std::int64_t> uses(field.source_places(), 0);
  const std::int64_t limit = most_uses(sources.size(), targets.size());
  const auto cost = [&](int target, int source) { return distance(source, target); };
  std::vector<int> left = targets;
  for (int round = 0; !left.empty(); ++round) {
    const MatchField match =
        matched(left, from_size(field), open, to_size(field), options.passes,
                options.seed + static_cast<std::uint64_t>(round), cost, as_before(field, open));
    std::vector<int> order = left;
    std::sort(order.begin(), order.end(), [&](int a, int b) {
      return std::tuple(match.nearest(a).distance, a) < std::tuple(match.nearest(b).distance, b);
    });
    std::vector<std::uint8_t> settled(field.source.size(), 0);
    for (const int target : order)
      for (std::size_t k = 0; k < MatchField::kKept; ++k) {
        const Match& found = (&match.nearest(target))[k];
        if (found.to < 0 || !open.has(found.to)) continue;
        field.source[static_cast<std::size_t>(target)] = found.to;
        field.distance[static_cast<std::size_t>(target)] = found.distance;
        settled[static_cast<std::size_t>(target)] = 1;
        if (++uses[static_cast<std::size_t>(found.to)] == limit) open.remove(found.to);
        break;
      }
    std::erase_if(left, [&](int target) { return settled[static_cast<std::size_t>(target)] != 0; });
  }
}

void assign_by_histogram(const PatchDistance& distance, const std::vector<int>& sources,
                         const std::vector<int>& targets, const RetrievalOptions& options,
                         NearestField& field) {
  std::vector<float> times(field.source_places(), 0.0f);
  const float one = static_cast<float>(sources.size()) / static_cast<float>(targets.size());
  for (const int target : targets)
    if (const std::int32_t source = field.source[static_cast<std::size_t>(target)]; source >= 0)
      times[static_cast<std::size_t>(source)] += one;
  for (float& each : times) each = std::max(each, 1.0f);
  const OpenPlaces open(field.source_width, field.source_height, sources);
  const auto cost = [&](int target, int source) {
    return (distance(source, target) + kVoteFloor) * times[static_cast<std::size_t>(source)];
  };
  const MatchField match = matched(targets, from_size(field), open, to_size(field), options.passes,
                                   options.seed, cost, as_before(field, open));
  for (const int target : targets) {
    const std::int32_t source = match.nearest(target).to;
    field.source[static_cast<std::size_t>(target)] = source;
    field.distance[static_cast<std::size_t>(target)] = distance(source, target);
  }
}

void add_completing(const PatchDistance& distance, const std::vector<int>& sources,
                    const std::vector<int>& targets, const RetrievalOptions& options,
                    const NearestField& sizes, double vote_power, std::vector<Completing>& pairs) {
  const OpenPlaces open(sizes.target_width, sizes.target_height, targets);
  const auto cost = [&](int source, int target) { return distance(source, target); };
  const MatchField match = matched(sources, to_size(sizes), open, from_size(sizes), options.passes,
                                   options.seed, cost, kNothingFirst);
  const float share = static_cast<float>(targets.size()) / static_cast<float>(sources.size());
  for (const int source : sources) {
    const Match& found = match.nearest(source);
    pairs.push_back({source, found.to, share * vote_weight(found.distance, vote_power)});
  }
}

}  // namespace freshet::bench
