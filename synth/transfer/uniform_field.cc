#include "synth/transfer/uniform_field.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include "platform/random.h"
#include "synth/transfer/open_places.h"

namespace freshet::synth::transfer {
namespace {

constexpr std::size_t kGrain = 512;  // targets a task
constexpr std::size_t kAhead = 32;   // targets whose sources are fetched before they are compared
constexpr int kUsersSeen = 4;        // of a source, to find the one to exchange with

std::size_t at(std::int32_t place) { return static_cast<std::size_t>(place); }

template <class Body>
void for_indices(std::size_t count, const Body& body) {
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, count, kGrain),
                            [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
                              for (std::size_t i = range.begin(); i < range.end(); ++i) body(i);
                            });
}

}  // namespace

UniformField::UniformField(const PatchDistance& distance, const std::vector<int>& sources,
                           const std::vector<int>& targets, std::uint64_t seed, NearestField& field)
    : distance_(distance),
      sources_(sources),
      targets_(targets),
      seed_(seed),
      field_(field),
      min_uses_(static_cast<std::int32_t>(targets.size() / sources.size())),
      left_over_(static_cast<std::int64_t>(targets.size() % sources.size())),
      uses_(field.source_places(), -1),
      first_(field.source_places(), -1),
      next_(field.source.size(), -1),
      before_(field.source.size(), -1),
      offers_(field.source_places()),
      trades_(targets.size()),
      changed_(field.source.size(), 0) {
  for (const int source : sources) uses_[at(source)] = 0;
  for_indices(targets.size(), [&](std::size_t i) {
    const std::int32_t target = targets[i];
    std::int32_t& source = field.source[at(target)];
    if (source >= 0 && uses_[at(source)] < 0) source = -1;
    if (source >= 0) field.distance[at(target)] = distance(source, target);
  });
  keep_what_is_uniform();
  fill();
}

void UniformField::give(std::int32_t source, std::int32_t target) {
  std::int32_t& uses = uses_[at(source)];
  left_over_ -= uses == min_uses_;
  ++uses;
  std::int32_t& first = first_[at(source)];
  next_[at(target)] = first;
  before_[at(target)] = -1;
  if (first >= 0) before_[at(first)] = target;
  first = target;
  field_.source[at(target)] = source;
}

void UniformField::take(std::int32_t source, std::int32_t target) {
  std::int32_t& uses = uses_[at(source)];
  --uses;
  left_over_ += uses == min_uses_;
  const std::int32_t before = before_[at(target)], next = next_[at(target)];
  (before >= 0 ? next_[at(before)] : first_[at(source)]) = next;
  if (next >= 0) before_[at(next)] = before;
}

void UniformField::keep_what_is_uniform() {
  // In order of distance, then of place: distances are not negative, and their bits are then in their order.
  std::vector<std::uint64_t> known;
  known.reserve(targets_.size());
  for (const int target : targets_)
    if (field_.source[at(target)] >= 0)
      known.push_back(std::uint64_t{std::bit_cast<std::uint32_t>(field_.distance[at(target)])} << 32 |
                      static_cast<std::uint32_t>(target));
  oneapi::tbb::parallel_sort(known.begin(), known.end());
  for (const std::uint64_t key : known) {
    const auto target = static_cast<std::int32_t>(key & 0xffffffffu);
    const std::int32_t source = field_.source[at(target)], uses = uses_[at(source)];
    if (uses < min_uses_ || (uses == min_uses_ && left_over_ > 0))
      give(source, target);
    else
      field_.source[at(target)] = -1;
  }
}

void UniformField::fill() {
  std::vector<int> owing, willing;  // below K uses; with K
  for (const int source : sources_) {
    if (uses_[at(source)] < min_uses_) owing.push_back(source);
    if (uses_[at(source)] == min_uses_) willing.push_back(source);
  }
  OpenPlaces must(field_.source_width, field_.source_height, owing),
      may(field_.source_width, field_.source_height, willing);
  const Random random(seed_, 0);
  for (const int target : targets_) {
    if (field_.source[at(target)] >= 0) continue;
    const std::uint64_t bits = random.bits(static_cast<std::uint64_t>(target));
    std::int32_t best = -1;
    float nearest = 0;
    const auto try_near = [&](std::int32_t place) {
      for (const OpenPlaces* open : {&must, &may}) {
        if (open == &may && left_over_ == 0) continue;
        const std::int32_t source =
            open->near(place % field_.source_width, place / field_.source_width, bits);
        if (source < 0 || source == best) continue;
        const float found = distance_(source, target);
        if (best >= 0 && !(found < nearest)) continue;
        best = source;
        nearest = found;
      }
    };
    for (const std::int32_t way : {-1, 1, -field_.target_width, field_.target_width})
      if (const std::int32_t of = field_.source[at(target + way)]; of >= 0) {
        const std::int32_t on =
            way == 1 || way == -1 ? of - way : of - way / field_.target_width * field_.source_width;
        if (on >= 0 && on < static_cast<std::int32_t>(uses_.size())) try_near(on);
      }
    if (best < 0) try_near(sources_[bits % sources_.size()]);
    give(best, target);
    field_.distance[at(target)] = nearest;
    const std::int32_t uses = uses_[at(best)];
    if (uses == min_uses_) {
      must.remove(best);
      may.add(best);
    } else if (uses > min_uses_) {
      may.remove(best);
    }
  }
}

// A pass asks eleven times a target: looked up then, users took three fifths of the time, waiting for memory.
void UniformField::list_offers() {
  for_indices(sources_.size(), [&](std::size_t i) {
    const std::int32_t source = sources_[i];
    Offer offer{.uses = uses_[at(source)], .user = first_[at(source)]};
    std::int32_t user = offer.user;
    if (user >= 0) offer.distance = field_.distance[at(user)];
    for (int seen = 1; seen < kUsersSeen && user >= 0; ++seen) {
      user = next_[at(user)];
      if (user < 0 || !(field_.distance[at(user)] > offer.distance)) continue;
      offer.user = user;
      offer.distance = field_.distance[at(user)];
    }
    offers_[at(source)] = offer;
  });
}

// Where the source of the target beside this one goes on; -1: nowhere, or in the target's own.
std::int32_t UniformField::beside(std::int32_t target, int dx, int dy) const {
  const std::int32_t of = target + dy * field_.target_width + dx;
  if (of < 0 || of >= static_cast<std::int32_t>(field_.source.size())) return -1;
  const std::int32_t source = field_.source[at(of)];
  if (source < 0) return -1;
  const std::int32_t on = source - dy * field_.source_width - dx;
  if (on == field_.source[at(target)]) return -1;  // so it mostly is, and nothing need be divided
  const int x = source % field_.source_width - dx, y = source / field_.source_width - dy;
  if (x < 0 || y < 0 || x >= field_.source_width || y >= field_.source_height) return -1;
  return on;
}

UniformField::Tries UniformField::tries(std::int32_t target, std::int32_t hint, Draw draw, int pass) const {
  Tries tries;
  tries.fill(-1);
  std::size_t count = 0;
  const std::int32_t own = field_.source[at(target)];
  const auto add = [&](std::int32_t source) {
    if (source < 0 || source == own) return;
    __builtin_prefetch(&offers_[at(source)]);
    tries[count++] = source;
  };
  add(hint);
  const int step = 1 << (1 + pass % 3);
  for (const int by : {1, step}) {
    add(beside(target, by, 0));
    add(beside(target, -by, 0));
    add(beside(target, 0, by));
    add(beside(target, 0, -by));
  }
  distance_.prefetch_source(draw.anywhere);
  add(draw.anywhere);
  const int x = own % field_.source_width, y = own / field_.source_width;
  for (int k = 0; k < 2; ++k) {
    draw.bits = scramble(draw.bits);
    const std::uint64_t bits = draw.bits;
    const int reach = 1 << (bits & 0xff) % 6;  // 1 to 32 px
    const std::uint64_t span = 2 * static_cast<std::uint64_t>(reach) + 1;
    const int to_x = x + static_cast<int>((bits >> 8 & 0xffffff) * span >> 24) - reach;
    const int to_y = y + static_cast<int>((bits >> 32 & 0xffffff) * span >> 24) - reach;
    if (to_x >= 0 && to_y >= 0 && to_x < field_.source_width && to_y < field_.source_height)
      add(to_y * field_.source_width + to_x);
  }
  return tries;
}

UniformField::Trade UniformField::best_trade(std::int32_t target, const Tries& tries) const {
  const std::int32_t own = field_.source[at(target)];
  const float distance = field_.distance[at(target)];
  const bool own_to_spare = offers_[at(own)].uses > min_uses_;

  // What is nearer to the target.
  std::array<Trade, kTries> nearer;
  std::size_t count = 0;
  for (const std::int32_t source : tries) {
    if (source < 0) break;
    const Offer& offer = offers_[at(source)];
    const bool spare = offer.uses == min_uses_ && own_to_spare;
    if (offer.uses < 0 || (!spare && offer.user < 0)) continue;
    const float found = distance_(source, target);
    if (!(found < distance)) continue;
    if (!spare) distance_.prefetch_target(offer.user);
    nearer[count++] = {.source = source, .partner = spare ? -1 : offer.user, .distance = found};
  }

  // Of these what is nearer for both.
  Trade best;
  float most = 0;
  for (Trade& trade : std::span(nearer.data(), count)) {
    float gain = distance - trade.distance;
    if (trade.partner >= 0) {
      const float partner = offers_[at(trade.source)].distance;
      if (!(gain + partner > most)) continue;  // not even if the partner's distance became 0
      trade.partners = distance_(own, trade.partner);
      gain += partner - trade.partners;
    }
    if (!(gain > most)) continue;
    best = trade;
    most = gain;
  }
  return best;
}

void UniformField::find_trades(std::size_t from, std::size_t to, int pass,
                               std::span<const std::int32_t> hints) {
  const Random random(seed_, 1 + static_cast<std::uint64_t>(pass));
  std::array<Draw, kAhead> draws;
  std::array<Tries, kAhead> ahead;
  for (; from < to; from += kAhead) {
    const std::size_t count = std::min(kAhead, to - from);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint64_t bits = random.bits(static_cast<std::uint64_t>(targets_[from + i]));
      draws[i] = {bits, sources_[bits % sources_.size()]};
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::int32_t target = targets_[from + i];
      ahead[i] = tries(target, hints.empty() ? -1 : hints[at(target)], draws[i], pass);
    }
    for (std::size_t i = 0; i < count; ++i) trades_[from + i] = best_trade(targets_[from + i], ahead[i]);
  }
}

void UniformField::exchange(int pass, std::span<const std::int32_t> hints) {
  list_offers();
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, targets_.size(), kGrain),
                            [&](const oneapi::tbb::blocked_range<std::size_t>& range) {
                              find_trades(range.begin(), range.end(), pass, hints);
                            });
  std::fill(changed_.begin(), changed_.end(), std::uint8_t{0});
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    const Trade& trade = trades_[i];
    const std::int32_t target = targets_[i];
    if (trade.source < 0 || changed_[at(target)]) continue;
    const std::int32_t own = field_.source[at(target)];
    if (trade.partner < 0) {
      if (uses_[at(trade.source)] != min_uses_ || uses_[at(own)] <= min_uses_) continue;
      take(own, target);
      give(trade.source, target);
    } else {
      if (changed_[at(trade.partner)]) continue;
      take(own, target);
      take(trade.source, trade.partner);
      give(trade.source, target);
      give(own, trade.partner);
      field_.distance[at(trade.partner)] = trade.partners;
      changed_[at(trade.partner)] = 1;
    }
    field_.distance[at(target)] = trade.distance;
    changed_[at(target)] = 1;
  }
}

}  // namespace freshet::synth::transfer
