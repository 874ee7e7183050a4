#include "synth/transfer/vote.h"

#include <algorithm>
#include <vector>

#include "platform/vectors.h"
#include "synth/field/portable_math.h"

namespace freshet::synth::transfer {
namespace {

// Pixels of a row from the patches centred in one row, dy above or below it.
FRESHET_WIDE
void add_row(const PixelGrid& source, const std::int32_t* from, const float* weights, int dy, int half,
             int width, Pixel* sum, float* weight_sum) {
  for (int centre = half; centre < width - half; ++centre) {
    const std::int32_t place = from[centre];
    if (place < 0) continue;
    const float weight = weights[centre];
    const Pixel* in = source.values.data() + place - static_cast<std::ptrdiff_t>(dy) * source.width - half;
    Pixel* out = sum + centre - half;
    for (int dx = 0; dx <= 2 * half; ++dx) {
      for (int c = 0; c < 4; ++c) out[dx].c[c] += weight * in[dx].c[c];
      weight_sum[centre - half + dx] += weight;
    }
  }
}

}  // namespace

float vote_weight(float distance, double power) {
  return pow_portable(distance + kVoteFloor, static_cast<float>(-power));
}

void vote(const PixelGrid& source, const NearestField& field, int patch, double power, PixelGrid& into) {
  const int width = field.target_width, height = field.target_height, half = patch / 2;
  Grid weights(width, height);
  for_rows(height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      if (field.source[at] >= 0) weights(x, y) = vote_weight(field.distance[at], power);
    }
  });
  oneapi::tbb::parallel_for(
      oneapi::tbb::blocked_range<int>(0, height, 16), [&](const oneapi::tbb::blocked_range<int>& rows) {
        std::vector<Pixel> sum(static_cast<std::size_t>(width));
        std::vector<float> weight(static_cast<std::size_t>(width));
        for (int y = rows.begin(); y < rows.end(); ++y) {
          std::fill(sum.begin(), sum.end(), Pixel{});
          std::fill(weight.begin(), weight.end(), 0.0f);
          for (int dy = -half; dy <= half; ++dy) {
            const int centre = y + dy;
            if (centre < half || centre >= height - half) continue;
            add_row(source, field.source.data() + static_cast<std::ptrdiff_t>(centre) * width,
                    weights.row(centre), dy, half, width, sum.data(), weight.data());
          }
          for (int x = 0; x < width; ++x) {
            const std::size_t at = static_cast<std::size_t>(x);
            if (weight[at] > 0)
              for (int c = 0; c < 4; ++c) into(x, y).c[c] = sum[at].c[c] / weight[at];
          }
        }
      });
}

}  // namespace freshet::synth::transfer
