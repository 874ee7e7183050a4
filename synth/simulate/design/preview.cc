#include "synth/simulate/design/preview.h"

#include <algorithm>
#include <cstdint>

#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {

void draw_preview(const Look& look, const Grid& density, const Grid& obstacles, cv::Mat& alpha,
                  GridOf<Rgb>& light) {
  const int w = density.width, h = density.height;
  const int reach = std::max(1, h / 180);
  for_rows(h, [&](int y) {
    const float* p = density.row(y);
    const float *above = density.row(std::max(y - reach, 0)),
                *below = density.row(std::min(y + reach, h - 1));
    Rgb* out = light.row(y);
    for (int x = 0; x < w; ++x) {
      const float a = 1.0f - exp_portable(-look.opacity * p[x]);
      if (alpha.depth() == CV_16U)
        alpha.ptr<std::uint16_t>(y)[x] = static_cast<std::uint16_t>(a * 65535.0f + 0.5f);
      else
        alpha.ptr<std::uint8_t>(y)[x] = static_cast<std::uint8_t>(a * 255.0f + 0.5f);
      const float solid = obstacles(x, y);
      const Rgb back = mix(Rgb{0.012f, 0.014f, 0.018f}, Rgb{0.11f, 0.1f, 0.09f}, solid);
      const int left = std::max(x - reach, 0), right = std::min(x + reach, w - 1);
      const float slope = (p[left] - p[right]) + (below[x] - above[x]);
      const float lit = std::clamp(0.62f + 0.3f * slope, 0.15f, 1.0f);
      const Rgb colour = mix(look.thin, look.dense, std::min(p[x], 1.0f));
      const Rgb lamp = colour * (lit * a), flame = colour * (2.5f * p[x]);
      out[x] = mix(mix(back, lamp + back * (1.0f - a), 1.0f - look.glow), back + flame, look.glow);
    }
  });
}

}  // namespace freshet::synth::simulate
