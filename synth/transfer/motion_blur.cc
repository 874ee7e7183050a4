#include "synth/transfer/motion_blur.h"

#include <algorithm>
#include <cmath>

#include "synth/field/portable_math.h"

namespace freshet::synth::transfer {
namespace {

constexpr float kLongest = 256.0f;  // px: no frame is smeared further, whatever the flow says

Pixel bilinear(const PixelGrid& picture, float x, float y) {
  const Tap tx = tap(x, picture.width), ty = tap(y, picture.height);
  const Pixel* a = picture.row(ty.index) + tx.index;
  const Pixel* b = picture.row(ty.index + ty.step) + tx.index;
  Pixel out;
  for (int c = 0; c < 4; ++c) {
    const float top = a[0].c[c] + (a[tx.step].c[c] - a[0].c[c]) * tx.weight;
    const float bottom = b[0].c[c] + (b[tx.step].c[c] - b[0].c[c]) * tx.weight;
    out.c[c] = top + (bottom - top) * ty.weight;
  }
  return out;
}

}  // namespace

PixelGrid blurred_along(const PixelGrid& picture, const VectorGrid& flow, double length) {
  PixelGrid out(picture.width, picture.height);
  for_rows(picture.height, [&](int y) {
    for (int x = 0; x < picture.width; ++x) {
      const Vec2 by = flow(x, y);
      const float smear =
          std::min(kLongest, static_cast<float>(length) * std::sqrt(by.x * by.x + by.y * by.y));
      const int steps = static_cast<int>(std::ceil(smear / 2));  // to each side, at most 1 px long
      if (steps == 0) {
        out(x, y) = picture(x, y);
        continue;
      }
      const float size = std::sqrt(by.x * by.x + by.y * by.y);
      const float step = smear / 2 / static_cast<float>(steps);
      Pixel sum;
      float weights = 0;
      for (int k = -steps; k <= steps; ++k) {
        const float at = 2.0f * static_cast<float>(k) / static_cast<float>(steps);  // standard deviations
        const float weight = exp_portable(-0.5f * at * at);
        const float along = static_cast<float>(k) * step / size;
        const Pixel read =
            bilinear(picture, static_cast<float>(x) + along * by.x, static_cast<float>(y) + along * by.y);
        for (int c = 0; c < 4; ++c) sum.c[c] += weight * read.c[c];
        weights += weight;
      }
      for (int c = 0; c < 4; ++c) out(x, y).c[c] = sum.c[c] / weights;
    }
  });
  return out;
}

}  // namespace freshet::synth::transfer
