#include "synth/scene/rendering/composite.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_for.h>

#include "platform/vectors.h"
#include "synth/sampling/bilinear.h"
#include "synth/sampling/cubic.h"

namespace freshet::synth::scene {
namespace {

using sampling::kCubic;
using sampling::kCubicShift;
using sampling::kCubicSteps;

constexpr int kRowsAtOnce = 8;
constexpr float kFurthest = 8000;  // px; further displacements are cut

typedef float Quad __attribute__((vector_size(16)));
/// Blue, green, red, alpha.
struct Sample {
  Quad of;
};

/// What one thread needs for a row.
struct Scratch {
  Scratch(int width, bool all_cover)
      : seen(static_cast<std::size_t>(width)),
        shown(all_cover ? 0 : seen.size()),
        sample(static_cast<std::size_t>(width)),
        through(static_cast<std::size_t>(width)),
        dx(static_cast<std::size_t>(width)),
        dy(dx),
        light(dx),
        part(dx),
        place_x(static_cast<std::size_t>(width)),
        place_y(place_x) {}
  std::vector<Sample> seen;    // so far
  std::vector<Sample> shown;   // the share of each channel of what lies behind; empty where all layers cover
  std::vector<Sample> sample;  // of one layer
  std::vector<Sample> other;   // its second copy; empty until one is asked for
  std::vector<float> wanted[2];
  std::vector<float> through;              // how much layers that cover leave of what lies behind
  std::vector<float> dx, dy, light, part;  // part: of the second copy
  std::vector<std::int32_t> place_x, place_y;
};

/// Places in steps of the texture, kept inside it. mirrored   1: what lies beyond an end is its mirror image; 0: the
/// end itself.
FRESHET_WIDE void places(const float* d, int from, int step, int n, int most, int mirrored,
                         std::int32_t* out) {
  for (int i = 0; i < n; ++i) {
    float v = d[i] < kFurthest ? d[i] : kFurthest;
    v = v > -kFurthest ? v : -kFurthest;
    // Rounded down from above zero: the truncation is the floor.
    const int moved = static_cast<int>(v * kCubicSteps + (kFurthest * kCubicSteps + 0.5f)) -
                      static_cast<int>(kFurthest) * kCubicSteps;
    int at = (from + i * step) * kCubicSteps + moved;
    at = at > 0 ? at : -at * mirrored;
    at = at < most ? at : most - (at - most) * mirrored;
    at = at > 0 ? at : 0;
    out[i] = at < most ? at : most;
  }
}

/// The texture at these places, where something can still be seen of it.
FRESHET_WIDE void sample_places(const float* texture, std::ptrdiff_t stride, const std::int32_t* x,
                                const std::int32_t* y, const float* through, int n, Sample* out) {
  for (int i = 0; i < n; ++i) {
    if (!(through[i] > 0)) continue;
    const int px = x[i], py = y[i];
    const float* from =
        texture + static_cast<std::ptrdiff_t>(py >> kCubicShift) * stride + 4 * (px >> kCubicShift);
    const auto quad = [](const float* at) { return *reinterpret_cast<const Quad*>(at); };
    const int part_x = px & (kCubicSteps - 1), part_y = py & (kCubicSteps - 1);
    if (part_x == 0 && part_y == 0) {
      out[i].of = quad(from);
      continue;
    }
    const auto& wx = kCubic.of[part_x];
    const auto& wy = kCubic.of[part_y];
    const auto row = [&](std::ptrdiff_t r) {
      const float* at = from + r * stride;
      return (quad(at - 4) * wx[0] + quad(at) * wx[1]) + (quad(at + 4) * wx[2] + quad(at + 8) * wx[3]);
    };
    Quad v = (row(-1) * wy[0] + row(0) * wy[1]) + (row(1) * wy[2] + row(2) * wy[3]);
    // A cubic swings beyond what is there: alpha stays in 0..1, and colours within alpha.
    const Quad zero{0, 0, 0, 0};
    const float alpha = v[3] < 1 ? (v[3] > 0 ? v[3] : 0) : 1;
    const Quad most{alpha, alpha, alpha, alpha};
    v = v > zero ? v : zero;
    out[i].of = v < most ? v : most;
  }
}

/// Lays what was sampled behind what is seen. held   alpha of its own, or null. shown   null where all layers cover:
/// the share of each channel is then `through`.
FRESHET_WIDE void lay_behind(const Sample* sample, const float* held, const float* light, Blend blend, int n,
                             Sample* seen, Sample* shown, float* through) {
  for (int i = 0; i < n; ++i) {
    if (!(through[i] > 0)) continue;
    Quad v = sample[i].of;
    if (held != nullptr) v = v * held[i];
    const float alpha = v[3];
    if (light != nullptr) v = v * light[i];
    if (shown == nullptr) {
      seen[i].of += v * through[i];
      through[i] *= 1 - alpha;
      continue;
    }
    seen[i].of += v * shown[i].of;
    if (blend == Blend::kAdd) continue;
    if (blend == Blend::kScreen) {
      shown[i].of = shown[i].of * (1 - v);
      continue;
    }
    shown[i].of = shown[i].of * (1 - alpha);
    through[i] *= 1 - alpha;
  }
}

/// Of what is to be seen of two copies, how much is the first's and how much the second's; `part` of the second.
FRESHET_WIDE void share(const float* through, const float* part, int n, float* first, float* second) {
  for (int i = 0; i < n; ++i) {
    first[i] = part[i] < 1 ? through[i] : 0;
    second[i] = part[i] > 0 ? through[i] : 0;
  }
}

FRESHET_WIDE void mix_samples(const Sample* other, const float* part, int n, Sample* sample) {
  for (int i = 0; i < n; ++i) {
    if (!(part[i] > 0)) continue;
    sample[i].of = part[i] < 1 ? sample[i].of + (other[i].of - sample[i].of) * part[i] : other[i].of;
  }
}

FRESHET_WIDE void write_bytes(const Sample* seen, int n, std::uint8_t* out) {
  for (int i = 0; i < n; ++i) {
    for (int c = 0; c < 3; ++c) {
      float v = seen[i].of[c] * 255 + 0.5f;
      v = v < 255 ? v : 255;
      out[3 * i + c] = static_cast<std::uint8_t>(static_cast<int>(v > 0 ? v : 0));
    }
  }
}

/// The picture's columns in which the layer can be seen in row y.
cv::Range columns_of(const MovedSprite& moved, int y, int width) {
  const Sprite& sprite = *moved.sprite;
  if (sprite.box.empty()) return {0, 0};
  const int row = y - sprite.box.y;
  if (sprite.outline != Outline::kMoves) {
    if (row < 0 || row >= sprite.box.height) return {0, 0};
    const cv::Range span = sprite.spans[static_cast<std::size_t>(row)];
    return {sprite.box.x + span.start, sprite.box.x + span.end};
  }
  const float reach = moved.motion->reach();
  const int around = reach > 0 ? static_cast<int>(std::ceil(std::min(reach, kFurthest))) + 2 : 0;
  const int first = std::max(0, row - around), last = std::min(sprite.box.height - 1, row + around);
  cv::Range all(width, 0);
  for (int r = first; r <= last; ++r) {
    const cv::Range span = sprite.spans[static_cast<std::size_t>(r)];
    if (span.empty()) continue;
    all.start = std::min(all.start, sprite.box.x + span.start - around);
    all.end = std::max(all.end, sprite.box.x + span.end + around);
  }
  return {std::max(0, all.start), std::max(std::max(0, all.start), std::min(width, all.end))};
}

/// Samples one copy of the layer in columns of row y, where something of it is wanted.
void sample_copy(const MovedSprite& moved, int copy, int y, cv::Range columns, Scratch& scratch,
                 const float* wanted, Sample* to) {
  const Sprite& sprite = *moved.sprite;
  const auto n = columns.size();
  moved.motion->row(copy, columns.start, y, n, scratch.dx.data(), scratch.dy.data());
  const int width = sprite.period(), height = sprite.texture.rows - 2 * Sprite::kBorder;
  // What moves has nothing at its ends; what is held would be smeared from them.
  const int mirrored = sprite.outline == Outline::kMoves ? 0 : 1;
  if (sprite.outline == Outline::kCyclic) {
    const auto period = static_cast<float>(width);
    for (int i = 0; i < n; ++i) {
      const float at =
          static_cast<float>(columns.start + i - sprite.box.x) + scratch.dx[static_cast<std::size_t>(i)];
      const float around = at - period * std::floor(at / period);
      scratch.place_x[static_cast<std::size_t>(i)] =
          std::clamp(static_cast<int>(around * kCubicSteps + 0.5f), 0, width * kCubicSteps - 1);
    }
  } else {
    places(scratch.dx.data(), columns.start - sprite.box.x, 1, n, (width - 1) * kCubicSteps, mirrored,
           scratch.place_x.data());
  }
  places(scratch.dy.data(), y - sprite.box.y, 0, n, (height - 1) * kCubicSteps, mirrored,
         scratch.place_y.data());
  const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(sprite.texture.step1());
  sample_places(sprite.texture.ptr<float>(Sprite::kBorder) + 4 * Sprite::kBorder, stride,
                scratch.place_x.data(), scratch.place_y.data(), wanted, n, to);
}

/// Both copies, each only where it is seen.
void sample_mixture(const MovedSprite& moved, int y, cv::Range columns, Scratch& scratch) {
  const int n = columns.size();
  const float* through = scratch.through.data() + columns.start;
  scratch.other.resize(scratch.sample.size());
  for (std::vector<float>& wanted : scratch.wanted) wanted.resize(scratch.dx.size());
  share(through, scratch.part.data(), n, scratch.wanted[0].data(), scratch.wanted[1].data());
  sample_copy(moved, 0, y, columns, scratch, scratch.wanted[0].data(), scratch.sample.data());
  sample_copy(moved, 1, y, columns, scratch, scratch.wanted[1].data(), scratch.other.data());
  mix_samples(scratch.other.data(), scratch.part.data(), n, scratch.sample.data());
}

/// On n pixels of row y, where something can still be seen of them.
void let_light_fall(std::span<const FallingLight* const> falling, int x, int y, int n, const float* through,
                    Sample* sample) {
  for (int i = 0; i < n; ++i) {
    if (!(through[i] > 0)) continue;
    Quad factor{1, 1, 1, 1};
    for (const FallingLight* const light : falling) {
      const float here = light->falloff->ptr<float>(y)[x + i];
      factor += Quad{light->gain[0], light->gain[1], light->gain[2], 0} * here;
    }
    const Quad zero{0, 0, 0, 0};
    sample[i].of *= factor > zero ? factor : zero;
  }
}

/// Factors of the light at n pixels; false: it is 1 everywhere, and nothing that counts was written. dx, dy   px, of
/// what the pixels show.
bool light_of(const MovedSprite& moved, int x, int y, int n, const float* dx, const float* dy,
              float* factor) {
  bool lit = moved.motion->light(x, y, n, factor);
  const auto by = [&](auto&& light) {
    for (int i = 0; i < n; ++i) factor[i] = lit ? factor[i] * light(i) : light(i);
    lit = true;
  };
  for (const cv::Mat* const map : moved.lights) {
    if (map == nullptr) continue;
    if (moved.light_moves && map == moved.lights[0])
      by([&](int i) {
        return sampling::bilinear<float>(*map, static_cast<float>(x + i) + dx[i],
                                         static_cast<float>(y) + dy[i]);
      });
    else
      by([row = map->ptr<float>(y) + x](int i) { return row[i]; });
  }
  if (moved.lit != nullptr) by([all = *moved.lit](int) { return all; });
  return lit;
}

void add_layer(const MovedSprite& moved, int y, cv::Range columns, Scratch& scratch) {
  const Sprite& sprite = *moved.sprite;
  const int n = columns.size();
  Sample* const sample = scratch.sample.data();
  if (moved.motion->second(columns.start, y, n, scratch.part.data()))
    sample_mixture(moved, y, columns, scratch);
  else
    sample_copy(moved, 0, y, columns, scratch, scratch.through.data() + columns.start, sample);
  if (!moved.falling.empty())
    let_light_fall(moved.falling, columns.start, y, n, scratch.through.data() + columns.start, sample);
  const float* held = sprite.held.empty()
                          ? nullptr
                          : sprite.held.ptr<float>(y - sprite.box.y) + (columns.start - sprite.box.x);
  const bool lit =
      light_of(moved, columns.start, y, n, scratch.dx.data(), scratch.dy.data(), scratch.light.data());
  lay_behind(sample, held, lit ? scratch.light.data() : nullptr, moved.blend, n,
             scratch.seen.data() + columns.start,
             scratch.shown.empty() ? nullptr : scratch.shown.data() + columns.start,
             scratch.through.data() + columns.start);
}

void composite_row(std::span<const MovedSprite> layers, int y, cv::Mat& out, Scratch& scratch) {
  const int width = out.cols;
  std::fill(scratch.seen.begin(), scratch.seen.end(), Sample{});
  std::fill(scratch.shown.begin(), scratch.shown.end(), Sample{{1, 1, 1, 1}});
  std::fill(scratch.through.begin(), scratch.through.end(), 1.0f);
  cv::Range open(0, width);  // outside of it all is hidden
  for (const MovedSprite& layer : layers) {
    const cv::Range columns = columns_of(layer, y, width) & open;
    if (columns.empty()) continue;
    add_layer(layer, y, columns, scratch);
    while (open.start < open.end && !(scratch.through[static_cast<std::size_t>(open.start)] > 0))
      ++open.start;
    while (open.end > open.start && !(scratch.through[static_cast<std::size_t>(open.end - 1)] > 0))
      --open.end;
    if (open.empty()) break;
  }
  if (out.type() == CV_8UC3) {
    write_bytes(scratch.seen.data(), width, out.ptr(y));
    return;
  }
  auto* to = out.ptr<cv::Vec4f>(y);
  for (int x = 0; x < width; ++x) {
    const Quad v = scratch.seen[static_cast<std::size_t>(x)].of;
    to[x] = {v[0], v[1], v[2], 1 - scratch.through[static_cast<std::size_t>(x)]};
  }
}

}  // namespace

void composite(std::span<const MovedSprite> nearest_first, cv::Mat& out) {
  const bool all_cover =
      std::ranges::all_of(nearest_first, [](const MovedSprite& each) { return each.blend == Blend::kOver; });
  oneapi::tbb::enumerable_thread_specific<Scratch> scratches([&] { return Scratch(out.cols, all_cover); });
  using oneapi::tbb::blocked_range;
  oneapi::tbb::parallel_for(blocked_range<int>(0, out.rows, kRowsAtOnce),
                            [&](const blocked_range<int>& rows) {
                              Scratch& scratch = scratches.local();
                              for (int y = rows.begin(); y < rows.end(); ++y)
                                composite_row(nearest_first, y, out, scratch);
                            });
}

}  // namespace freshet::synth::scene
