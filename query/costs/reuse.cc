#include "query/costs/reuse.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

namespace freshet::query {
namespace {

/// Where a candidate lies in its clip.
struct Place {
  std::uint32_t clip = 0;
  std::uint8_t variant = 0;
  int x = 0, y = 0;                  // px of the variant
  float middle_x = 0, middle_y = 0;  // px of the clip
  float extent = 0;                  // px of the clip, across
};

float overlap(const Place& a, const Place& b) {
  const float extent = 0.5f * (a.extent + b.extent);
  return std::max(0.0f, 1 - std::abs(a.middle_x - b.middle_x) / extent) *
         std::max(0.0f, 1 - std::abs(a.middle_y - b.middle_y) / extent);
}

}  // namespace

void add_reuse_costs(const store::Snapshot& snapshot, const vision::Settings& settings,
                     const stored::PatchTable& table, const Target& target, const Candidates& candidates,
                     const ReuseCosts& weights, Mrf& mrf) {
  if (weights.overlap <= 0) return;
  assert(mrf.edges.size() == target.edges.size());
  const std::vector<vision::Variant> variants = settings.variants();
  std::map<std::pair<std::uint32_t, std::uint8_t>, vision::VariantFrame> frames;
  std::vector<Place> places(candidates.rows.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const stored::Row row = candidates.rows[i];
    if (row == stored::kNoRow) continue;
    Place& place = places[i];
    place = {.clip = table.clip[row], .variant = table.variant[row], .x = table.x[row], .y = table.y[row]};
    auto found = frames.find({place.clip, place.variant});
    if (found == frames.end()) {
      const store::ClipRecord& record = snapshot.clip(table.clips[place.clip]);
      found = frames
                  .emplace(
                      std::pair(place.clip, place.variant),
                      vision::variant_frame({static_cast<int>(record.width), static_cast<int>(record.height)},
                                            variants[place.variant]))
                  .first;
    }
    const double half = (settings.grid.patch - 1) / 2.0;
    const cv::Vec2d middle = found->second.source_from_variant * cv::Vec3d(place.x + half, place.y + half, 1);
    place.middle_x = static_cast<float>(middle[0]);
    place.middle_y = static_cast<float>(middle[1]);
    place.extent = static_cast<float>(settings.grid.patch / variants[place.variant].scale);
  }

  const auto weight = static_cast<float>(weights.overlap);
  oneapi::tbb::parallel_for(std::size_t{0}, target.edges.size(), [&](std::size_t e) {
    const auto [p, q] = target.edges[e];
    const cv::Point step = (target.places[q] - target.places[p]) * target.stride;
    const Place *ours = places.data() + p * candidates.k, *theirs = places.data() + q * candidates.k;
    PairCost* cost = mrf.table(mrf.edges[e]);
    for (std::uint32_t i = 0; i < candidates.counts[p]; ++i)
      for (std::uint32_t j = 0; j < candidates.counts[q]; ++j, ++cost) {
        const Place &a = ours[i], &b = theirs[j];
        if (a.clip != b.clip) continue;
        if (a.variant == b.variant && b.x - a.x == step.x && b.y - a.y == step.y) continue;
        if (const float shared = overlap(a, b); shared > 0) *cost = *cost + weight * shared;
      }
  });
}

}  // namespace freshet::query
