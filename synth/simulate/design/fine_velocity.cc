// synth/simulate/design/fine_velocity.cc
#include "synth/simulate/design/fine_velocity.h"

#include <algorithm>

#include "platform/vectors.h"
#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {
namespace {

/// One row of both components: four coarse rows each, widened already.
FRESHET_WIDE void blend_rows(const float* const* u, const float* wu, float scale_u, const float* const* v,
                             const float* wv, float scale_v, int width, Vec2* out) {
  const float *u0 = u[0], *u1 = u[1], *u2 = u[2], *u3 = u[3];
  const float *v0 = v[0], *v1 = v[1], *v2 = v[2], *v3 = v[3];
  const float a = wu[0] * scale_u, b = wu[1] * scale_u, c = wu[2] * scale_u, d = wu[3] * scale_u;
  const float e = wv[0] * scale_v, f = wv[1] * scale_v, g = wv[2] * scale_v, h = wv[3] * scale_v;
  for (int x = 0; x < width; ++x) {
    out[x] = {a * u0[x] + b * u1[x] + c * u2[x] + d * u3[x], e * v0[x] + f * v1[x] + g * v2[x] + h * v3[x]};
  }
}

}  // namespace

FineVelocity::FineVelocity(cv::Size cells, cv::Size picture)
    : px_per_cell_x_(static_cast<float>(picture.width) / static_cast<float>(cells.width)),
      px_per_cell_y_(static_cast<float>(picture.height) / static_cast<float>(cells.height)),
      u_across_(taps(cells.width + 1, cells.width, picture.width, 0.0f)),
      u_down_(taps(cells.height, cells.height, picture.height, 0.5f)),
      v_across_(taps(cells.width, cells.width, picture.width, 0.5f)),
      v_down_(taps(cells.height + 1, cells.height, picture.height, 0.0f)),
      wide_u_(picture.width, cells.height),
      wide_v_(picture.width, cells.height + 1) {}

std::vector<FineVelocity::CubicTap> FineVelocity::taps(int samples, int cells, int pixels, float first) {
  std::vector<CubicTap> result(static_cast<std::size_t>(pixels));
  for (int i = 0; i < pixels; ++i) {
    const float at =
        (static_cast<float>(i) + 0.5f) * static_cast<float>(cells) / static_cast<float>(pixels) - first;
    const int left = floor_int(at);
    const float t = at - static_cast<float>(left), t2 = t * t, t3 = t2 * t;
    CubicTap& tap = result[static_cast<std::size_t>(i)];
    const float weight[4] = {-0.5f * t3 + t2 - 0.5f * t, 1.5f * t3 - 2.5f * t2 + 1.0f,
                             -1.5f * t3 + 2.0f * t2 + 0.5f * t, 0.5f * t3 - 0.5f * t2};
    for (int k = 0; k < 4; ++k) {
      tap.index[k] = std::clamp(left - 1 + k, 0, samples - 1);
      tap.weight[k] = weight[k];
    }
  }
  return result;
}

void FineVelocity::widen(const Grid& in, const std::vector<CubicTap>& across, Grid& out) const {
  for_rows(in.height, [&](int y) {
    const float* p = in.row(y);
    float* q = out.row(y);
    for (std::size_t x = 0; x < across.size(); ++x) {
      const CubicTap& t = across[x];
      q[x] = t.weight[0] * p[t.index[0]] + t.weight[1] * p[t.index[1]] + t.weight[2] * p[t.index[2]] +
             t.weight[3] * p[t.index[3]];
    }
  });
}

void FineVelocity::read(const Grid& u, const Grid& v, VectorGrid& velocity) {
  widen(u, u_across_, wide_u_);
  widen(v, v_across_, wide_v_);
  for_rows(velocity.height, [&](int y) {
    const CubicTap &tu = u_down_[static_cast<std::size_t>(y)], &tv = v_down_[static_cast<std::size_t>(y)];
    const float *rows_u[4], *rows_v[4];
    for (int k = 0; k < 4; ++k) rows_u[k] = wide_u_.row(tu.index[k]), rows_v[k] = wide_v_.row(tv.index[k]);
    blend_rows(rows_u, tu.weight, px_per_cell_x_, rows_v, tv.weight, px_per_cell_y_, velocity.width,
               velocity.row(y));
  });
}

}  // namespace freshet::synth::simulate
