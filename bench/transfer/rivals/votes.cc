#include "bench/transfer/rivals/votes.h"

#include <limits>

#include "synth/field/portable_math.h"
#include "synth/transfer/vote.h"

namespace freshet::bench {
namespace {

using namespace synth::transfer;

// Calls see(pixel of the exemplar, weight) for each patch over (x, y).
void for_proposals(const PixelGrid& source, const NearestField& field, const std::vector<float>& weights,
                   int half, int x, int y, const auto& see) {
  for (int dy = -half; dy <= half; ++dy)
    for (int dx = -half; dx <= half; ++dx) {
      if (x + dx < 0 || x + dx >= field.target_width || y + dy < 0 || y + dy >= field.target_height) continue;
      const auto at = static_cast<std::size_t>((y + dy) * field.target_width + x + dx);
      if (field.source[at] >= 0)
        see(source.values[static_cast<std::size_t>(field.source[at] - dy * source.width - dx)], weights[at]);
    }
}

std::vector<float> weights_of(const NearestField& field, double power) {
  std::vector<float> weights(field.source.size(), 0.0f);
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (field.source[i] >= 0) weights[i] = vote_weight(field.distance[i], power);
  return weights;
}

void add(Pixel& to, const Pixel& pixel, float weight) {
  for (int c = 0; c < 4; ++c) to.c[c] += weight * pixel.c[c];
}

}  // namespace

void vote_discrete(const PixelGrid& source, const NearestField& field, int patch, double power,
                   PixelGrid& into) {
  const std::vector<float> weights = weights_of(field, power);
  const int half = patch / 2;
  synth::for_rows(into.height, [&](int y) {
    for (int x = 0; x < into.width; ++x) {
      Pixel mean;
      float total = 0;
      for_proposals(source, field, weights, half, x, y, [&](const Pixel& pixel, float weight) {
        add(mean, pixel, weight);
        total += weight;
      });
      if (total <= 0) continue;
      for (float& value : mean.c) value /= total;
      float least = std::numeric_limits<float>::infinity();
      for_proposals(source, field, weights, half, x, y, [&](const Pixel& pixel, float) {
        float off = 0;
        for (int c = 0; c < 4; ++c) off += (pixel.c[c] - mean.c[c]) * (pixel.c[c] - mean.c[c]);
        if (off < least) least = off, into(x, y) = pixel;
      });
    }
  });
}

void vote_bidirectional(const PixelGrid& source, const NearestField& field,
                        const std::vector<Completing>& pairs, int patch, double power, PixelGrid& into) {
  const std::vector<float> weights = weights_of(field, power);
  const int half = patch / 2;
  PixelGrid sum(into.width, into.height);
  synth::Grid total(into.width, into.height);
  synth::for_rows(into.height, [&](int y) {
    for (int x = 0; x < into.width; ++x)
      for_proposals(source, field, weights, half, x, y, [&](const Pixel& pixel, float weight) {
        add(sum(x, y), pixel, weight);
        total(x, y) += weight;
      });
  });
  for (const Completing& pair : pairs)
    for (int dy = -half; dy <= half; ++dy)
      for (int dx = -half; dx <= half; ++dx) {
        const auto at = static_cast<std::size_t>(pair.target + dy * into.width + dx);
        add(sum.values[at], source.values[static_cast<std::size_t>(pair.source + dy * source.width + dx)],
            pair.weight);
        total.values[at] += pair.weight;
      }
  for (std::size_t i = 0; i < sum.values.size(); ++i)
    if (total.values[i] > 0)
      for (int c = 0; c < 4; ++c) into.values[i].c[c] = sum.values[i].c[c] / total.values[i];
}

}  // namespace freshet::bench
