#include "synth/transfer/forward_warp.h"

#include <algorithm>

#include "synth/field/portable_math.h"

namespace freshet::synth::transfer {
namespace {

constexpr float kEmptyWeight = 1e-3f;  // of a pixel without fluid
constexpr float kMinWeight = 1e-6f;    // below, nothing has come

}  // namespace

WarpedFrame forward_warp(const PixelGrid& picture, const Grid& mask, const VectorGrid& flow) {
  const int width = picture.width, height = picture.height;
  WarpedFrame out{PixelGrid(width, height), Grid(width, height)};
  Grid weights(width, height);
  // One thread: pixels meet, and the order of a sum is its last bit. 20 ms per megapixel.
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec2 by = flow(x, y);
      const float to_x = static_cast<float>(x) + by.x, to_y = static_cast<float>(y) + by.y;
      if (!(to_x > -1.0f && to_y > -1.0f && to_x < static_cast<float>(width) &&
            to_y < static_cast<float>(height)))
        continue;
      const int left = floor_int(to_x), top = floor_int(to_y);
      const float fx = to_x - static_cast<float>(left), fy = to_y - static_cast<float>(top);
      const Pixel& pixel = picture(x, y);
      const float opacity = std::max(pixel.c[3], mask(x, y)) + kEmptyWeight;
      for (int k = 0; k < 4; ++k) {
        const int px = left + k % 2, py = top + k / 2;
        if (px < 0 || py < 0 || px >= width || py >= height) continue;
        const float weight = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy) * opacity;
        for (int c = 0; c < 4; ++c) out.picture(px, py).c[c] += weight * pixel.c[c];
        out.mask(px, py) += weight * mask(x, y);
        weights(px, py) += weight;
      }
    }
  for (std::size_t i = 0; i < weights.values.size(); ++i) {
    const float weight = weights.values[i];
    for (float& value : out.picture.values[i].c) value = weight > kMinWeight ? value / weight : 0.0f;
    out.mask.values[i] = weight > kMinWeight ? out.mask.values[i] / weight : 0.0f;
  }
  return out;
}

Grid local_lambda(const Grid& mask, const Grid& warped_mask, double lambda) {
  Grid out(mask.width, mask.height);
  for (std::size_t i = 0; i < out.values.size(); ++i)
    out.values[i] =
        (1.0f - std::max(0.0f, mask.values[i] - warped_mask.values[i])) * static_cast<float>(lambda);
  return out;
}

GridOf<std::int32_t> carried(const GridOf<std::int32_t>& addresses, const VectorGrid& flow) {
  GridOf<std::int32_t> out(addresses.width, addresses.height, -1);
  for_rows(out.height, [&](int y) {
    for (int x = 0; x < out.width; ++x) {
      const Vec2 by = flow(x, y);
      const float from_x = static_cast<float>(x) - by.x + 0.5f, from_y = static_cast<float>(y) - by.y + 0.5f;
      if (from_x >= 0 && from_y >= 0 && from_x < static_cast<float>(out.width) &&
          from_y < static_cast<float>(out.height))
        out(x, y) = addresses(static_cast<int>(from_x), static_cast<int>(from_y));
    }
  });
  return out;
}

}  // namespace freshet::synth::transfer
