#include "synth/scene/water/reduced_tile.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "platform/vectors.h"

namespace freshet::synth::scene {
namespace {

/// Added to the level at which a pixel covers one sample: at 1 the shortest wave left is some 4 px long.
constexpr double kSoft = 1.0;

struct Level {
  int lower;
  float upper_part;  // of lower + 1
};
Level level_of(double covers, int levels) {
  const double exact = std::clamp(std::log2(std::max(covers, 1e-9)) + kSoft, 0.0, levels - 1.0);
  const int lower = std::min(static_cast<int>(exact), levels - 2);
  return {lower, static_cast<float>(exact - lower)};
}

FRESHET_WIDE void halve_rows(const float* a, const float* b, const float* c, const float* d, int n,
                             float* out) {
  for (int i = 0; i < n; ++i) out[i] = 0.125f * ((a[i] + d[i]) + 3 * (b[i] + c[i]));
}

FRESHET_WIDE void halve_along(const float* in, int n, float* out) {
  const int half = n / 2;
  out[0] = 0.125f * ((in[n - 1] + in[2 % n]) + 3 * (in[0] + in[1]));
  for (int i = 1; i + 1 < half; ++i)
    out[i] = 0.125f * ((in[2 * i - 1] + in[2 * i + 2]) + 3 * (in[2 * i] + in[2 * i + 1]));
  if (half > 1) {
    const int i = half - 1;
    out[i] = 0.125f * ((in[2 * i - 1] + in[0]) + 3 * (in[2 * i] + in[2 * i + 1]));
  }
}

FRESHET_WIDE void add_rows(const float* a, const float* b, const float* c, const float* d,
                           const float* weight, int n, float* out) {
  const float wa = weight[0], wb = weight[1], wc = weight[2], wd = weight[3];
  for (int i = 0; i < n; ++i) out[i] += (wa * a[i] + wb * b[i]) + (wc * c[i] + wd * d[i]);
}

/// Catmull-Rom.
void cubic_weights(float t, float scale, float* weight) {
  weight[0] = scale * 0.5f * t * (t * (2 - t) - 1);
  weight[1] = scale * 0.5f * (t * t * (3 * t - 5) + 2);
  weight[2] = scale * 0.5f * t * (t * (4 - 3 * t) + 1);
  weight[3] = scale * 0.5f * t * t * (t - 1);
}

/// Adds the row at y of one level to `sum`, n >> level_x values.
void add_level(const ReducedTile& tile, int level_x, int level_y, double y, float part, float* sum) {
  const cv::Mat& level = tile.level(level_x, level_y);
  const double at = (y + 0.5) / (1 << level_y) - 0.5, whole = std::floor(at);
  float weight[4];
  cubic_weights(static_cast<float>(at - whole), part, weight);
  const int mask = level.rows - 1;
  const auto row = [&](int offset) {
    return level.ptr<float>(static_cast<int>(static_cast<long long>(whole) + offset) & mask);
  };
  add_rows(row(-1), row(0), row(1), row(2), weight, level.cols, sum);
}

/// out += part * the row, brought from n >> level to n values linearly.
void add_enlarged(const float* row, int level, int n, float part, float* out) {
  const int size = n >> level, mask = size - 1;
  if (level == 0) {
    for (int i = 0; i < n; ++i) out[i] += part * row[i];
    return;
  }
  const int times = 1 << level;
  const float step = 1.0f / static_cast<float>(times);
  // Sample k stands at (k + .5) times - .5: half of an enlarged cell lies before it.
  for (int k = 0; k < size; ++k) {
    const float from = part * row[k], rise = part * row[(k + 1) & mask] - from;
    const int first = k * times + times / 2;
    for (int i = 0; i < times; ++i)
      out[(first + i) & (n - 1)] += from + rise * ((static_cast<float>(i) + 0.5f) * step);
  }
}

}  // namespace

ReducedTile::ReducedTile(int n)
    : levels_(std::bit_width(static_cast<unsigned>(n))),
      of_(static_cast<std::size_t>(levels_ * levels_)),
      needed_(of_.size(), 0) {}

void ReducedTile::need(int x, int y) {
  // Along x first, then down.
  for (int i = 0; i <= x; ++i) needed_[index(i, 0)] = 1;
  for (int i = 0; i <= y; ++i) needed_[index(x, i)] = 1;
}

void ReducedTile::set(const cv::Mat& tile) {
  of_[0] = tile;
  for (int y = 0; y < levels_; ++y) {
    for (int x = 0; x < levels_; ++x) {
      if (!needed_[index(x, y)] || (x == 0 && y == 0)) continue;
      const cv::Mat& from = y == 0 ? of_[index(x - 1, 0)] : of_[index(x, y - 1)];
      cv::Mat& to = of_[index(x, y)];
      to.create(y == 0 ? from.rows : from.rows / 2, y == 0 ? from.cols / 2 : from.cols, CV_32F);
      const int mask = from.rows - 1;
      for (int r = 0; r < to.rows; ++r) {
        if (y == 0)
          halve_along(from.ptr<float>(r), from.cols, to.ptr<float>(r));
        else
          halve_rows(from.ptr<float>((2 * r - 1) & mask), from.ptr<float>(2 * r), from.ptr<float>(2 * r + 1),
                     from.ptr<float>((2 * r + 2) & mask), to.cols, to.ptr<float>(r));
      }
    }
  }
}

void need_row(ReducedTile& tile, double covers_x, double covers_y) {
  const int x = level_of(covers_x, tile.levels()).lower, y = level_of(covers_y, tile.levels()).lower;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) tile.need(x + i, y + j);
}

void sample_row(const ReducedTile& tile, double y, double covers_x, double covers_y, int n, float* out,
                float* scratch) {
  const Level lx = level_of(covers_x, tile.levels()), ly = level_of(covers_y, tile.levels());
  std::fill(out, out + n, 0.0f);
  for (int i = 0; i < 2; ++i) {
    const float part_x = i == 0 ? 1 - lx.upper_part : lx.upper_part;
    if (part_x == 0) continue;
    const int level_x = lx.lower + i;
    std::fill(scratch, scratch + (n >> level_x), 0.0f);
    for (int j = 0; j < 2; ++j) {
      const float part_y = j == 0 ? 1 - ly.upper_part : ly.upper_part;
      if (part_y != 0) add_level(tile, level_x, ly.lower + j, y, part_y, scratch);
    }
    add_enlarged(scratch, level_x, n, part_x, out);
  }
}

}  // namespace freshet::synth::scene
