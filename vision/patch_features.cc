#include "vision/patch_features.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "freshet/error.h"

namespace freshet::vision {
namespace {

constexpr int kMaxChannels = first_channel(kMaxBands);

// Bilinear readings of a cell map at points of the source, all channels at once. Beyond the centres of the
// outermost cells the map goes on as they are.
class Sampler {
 public:
  explicit Sampler(const CellMap& map) : map_(map), per_cell_(1.0 / map.cell) {
    const std::size_t needed = static_cast<std::size_t>(std::max(map.rows, 0)) *
                               static_cast<std::size_t>(std::max(map.columns, 0)) *
                               static_cast<std::size_t>(std::max(map.channels, 0));
    if (needed == 0 || map.values.size() < needed || !(map.cell > 0)) {
      throw Error(ErrorKind::kDamaged, "cell map",
                  std::to_string(map.values.size()) + " values for " + std::to_string(map.rows) + " x " +
                      std::to_string(map.columns) + " cells of " + std::to_string(map.channels));
    }
  }

  // The first `channels` values at a source px (pixel centres).
  void read(double x, double y, int channels, float* out) const {
    const double column = std::clamp((x + 0.5) * per_cell_ - 0.5, 0.0, map_.columns - 1.0);
    const double row = std::clamp((y + 0.5) * per_cell_ - 0.5, 0.0, map_.rows - 1.0);
    const int left = static_cast<int>(column), top = static_cast<int>(row);  // not negative: this is floor
    const auto fx = static_cast<float>(column - left), fy = static_cast<float>(row - top);
    const std::size_t right = left + 1 < map_.columns ? static_cast<std::size_t>(map_.channels) : 0;
    const std::size_t below =
        top + 1 < map_.rows ? static_cast<std::size_t>(map_.channels) * map_.columns : 0;
    const float* a =
        map_.values.data() + (static_cast<std::size_t>(top) * map_.columns + left) * map_.channels;
    const float *b = a + right, *c = a + below, *d = c + right;
    const float wa = (1 - fx) * (1 - fy), wb = fx * (1 - fy), wc = (1 - fx) * fy, wd = fx * fy;
    for (int i = 0; i < channels; ++i) out[i] = wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i];
  }

 private:
  const CellMap& map_;
  double per_cell_;
};

// Calls visit(index, source x, source y) for the centre of each cell of a patch, row by row.
template <typename Visit>
void for_each_cell(const VariantFrame& frame, int x, int y, int cells, int cell, Visit visit) {
  const cv::Matx23d& m = frame.source_from_variant;
  for (int row = 0; row < cells; ++row) {
    const double py = y + (row + 0.5) * cell - 0.5;
    for (int column = 0; column < cells; ++column) {
      const double px = x + (column + 0.5) * cell - 0.5;
      visit(row * cells + column, m(0, 0) * px + m(0, 1) * py + m(0, 2),
            m(1, 0) * px + m(1, 1) * py + m(1, 2));
    }
  }
}

}  // namespace

int feature_channels(const SpectrumOptions& options) {
  return 2 + 2 * motion_bands(options) + kTextureLevels;
}

void patch_features(const CellMap& motion, const CellMap& texture, const VariantFrame& frame, int x, int y,
                    int patch, const SpectrumOptions& options, std::span<float> out) {
  const int bands = motion_bands(options), channels = feature_channels(options);
  if (motion.channels != motion_channels(options) || texture.channels != kTextureLevels) {
    throw Error(ErrorKind::kDamaged, "cell map",
                std::to_string(motion.channels) + " motion and " + std::to_string(texture.channels) +
                    " texture channels, " + std::to_string(motion_channels(options)) + " and " +
                    std::to_string(kTextureLevels) + " expected");
  }
  const int cells = options.cell > 0 ? patch / options.cell : 0;
  if (cells < 1 || out.size() < static_cast<std::size_t>(cells) * cells * channels) {
    throw Error(ErrorKind::kUsage, "patch features",
                "room for " + std::to_string(cells) + " x " + std::to_string(cells) + " cells of " +
                    std::to_string(channels) + " values expected");
  }
  const Sampler motion_at(motion), texture_at(texture);

  // v' = A v, so power turns by the squares of A's rows: E|a U + b V|^2 = a^2 Puu + 2 a b Puv + b^2 Pvv.
  const cv::Matx22d& A = frame.variant_from_source_velocity;
  const auto a = static_cast<float>(A(0, 0)), b = static_cast<float>(A(0, 1));
  const auto c = static_cast<float>(A(1, 0)), d = static_cast<float>(A(1, 1));
  const float aa = a * a, ab = 2 * a * b, bb = b * b, cc = c * c, cd = 2 * c * d, dd = d * d;

  std::array<float, kMaxChannels> here;
  for_each_cell(frame, x, y, cells, options.cell, [&](int index, double sx, double sy) {
    float* to = out.data() + static_cast<std::size_t>(index) * channels;
    motion_at.read(sx, sy, motion.channels, here.data());
    to[0] = a * here[0] + b * here[1];
    to[1] = c * here[0] + d * here[1];
    float *power_u = to + 2, *power_v = power_u + bands;
    for (int band = 0; band < bands; ++band) {
      const auto [uu, vv, uv] = band_power(here.data(), band);
      power_u[band] = std::max(0.0f, aa * uu + ab * uv + bb * vv);  // rounding may leave a trace below zero
      power_v[band] = std::max(0.0f, cc * uu + cd * uv + dd * vv);
    }
    texture_at.read(sx, sy, kTextureLevels, power_v + bands);
  });
}

cv::Vec2f patch_mean_motion(const CellMap& motion, const VariantFrame& frame, int x, int y, int patch) {
  const int cell = std::max(1, static_cast<int>(std::lround(motion.cell)));
  const int cells = patch / cell;
  if (cells < 1 || motion.channels < 2) {
    throw Error(ErrorKind::kUsage, "patch motion", "a patch of a cell or more expected");
  }
  const Sampler motion_at(motion);
  cv::Vec2d sum;
  for_each_cell(frame, x, y, cells, cell, [&](int, double sx, double sy) {
    std::array<float, 2> here;
    motion_at.read(sx, sy, 2, here.data());
    sum += cv::Vec2d(here[0], here[1]);
  });
  const cv::Vec2d turned = frame.variant_from_source_velocity * (sum * (1.0 / (cells * cells)));
  return {static_cast<float>(turned[0]), static_cast<float>(turned[1])};
}

}  // namespace freshet::vision
