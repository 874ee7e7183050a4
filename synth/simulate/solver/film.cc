// synth/simulate/solver/film.cc
#include "synth/simulate/solver/film.h"

#include <algorithm>
#include <cmath>

#include "platform/random.h"
#include "synth/field/portable_math.h"

namespace freshet::synth::simulate {
namespace {

constexpr float kWhite = 16.0f;  // light above it is clipped
constexpr int kBloomStep = 4;

float tone(float x) {
  const float mapped = x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f);
  return pow_portable(std::clamp(mapped, 0.0f, 1.0f), 1.0f / 2.2f);
}

/// Running mean over 2 r + 1 values of a row, ends repeated.
void box_rows(const GridOf<Rgb>& in, GridOf<Rgb>& out, int r) {
  for_rows(in.height, [&](int y) {
    const Rgb* p = in.row(y);
    Rgb* q = out.row(y);
    const int last = in.width - 1;
    const float scale = 1.0f / static_cast<float>(2 * r + 1);
    // Summed afresh at each pixel rather than slid: sliding lets rounding errors of a bright spot trail
    // behind it.
    for (int x = 0; x <= last; ++x) {
      Rgb sum;
      for (int k = x - r; k <= x + r; ++k) sum = sum + p[std::clamp(k, 0, last)];
      q[x] = sum * scale;
    }
  });
}
void box_columns(const GridOf<Rgb>& in, GridOf<Rgb>& out, int r) {
  for_rows(in.height, [&](int y) {
    Rgb* q = out.row(y);
    const float scale = 1.0f / static_cast<float>(2 * r + 1);
    std::fill(q, q + in.width, Rgb{});
    for (int k = y - r; k <= y + r; ++k) {
      const Rgb* p = in.row(std::clamp(k, 0, in.height - 1));
      for (int x = 0; x < in.width; ++x) q[x] = q[x] + p[x];
    }
    for (int x = 0; x < in.width; ++x) q[x] = q[x] * scale;
  });
}

}  // namespace

Film::Film(cv::Size size, const FilmOptions& options, std::uint64_t seed)
    : light(size.width, size.height), options_(options), seed_(static_cast<std::uint32_t>(scramble(seed))) {
  small_ = blurred_ =
      GridOf<Rgb>((size.width + kBloomStep - 1) / kBloomStep, (size.height + kBloomStep - 1) / kBloomStep);
  for (std::size_t i = 0; i < curve_.size(); ++i) {
    const float root = static_cast<float>(i) / static_cast<float>(curve_.size() - 1);
    curve_[i] = 255.0f * tone(root * root * kWhite);
  }
}

void Film::spread() {
  for_rows(small_.height, [&](int y) {
    const int y0 = y * kBloomStep, y1 = std::min(y0 + kBloomStep, light.height);
    for (int x = 0; x < small_.width; ++x) {
      const int x0 = x * kBloomStep, x1 = std::min(x0 + kBloomStep, light.width);
      Rgb sum;
      for (int j = y0; j < y1; ++j) {
        for (int i = x0; i < x1; ++i) sum = sum + light(i, j);
      }
      small_(x, y) = sum * (1.0f / static_cast<float>((y1 - y0) * (x1 - x0)));
    }
  });
  const int radius = std::clamp(light.height / 40 / kBloomStep, 1, 12);
  for (int pass = 0; pass < 2; ++pass) {
    box_rows(small_, blurred_, radius);
    box_columns(blurred_, small_, radius);
  }
}

void Film::develop(int frame, cv::Mat& picture) {
  picture.create(light.height, light.width, CV_8UC3);
  const bool bloom = options_.bloom > 0.0f;
  if (bloom) spread();
  const float kept = 1.0f - options_.bloom;
  const float last = static_cast<float>(curve_.size() - 1);
  const std::uint32_t frame_key = scramble32(seed_ + static_cast<std::uint32_t>(frame) * 0x9e3779b9u);
  for_rows(light.height, [&](int y) {
    std::uint8_t* out = picture.ptr<std::uint8_t>(y);
    const Rgb* in = light.row(y);
    const float small_y = (static_cast<float>(y) + 0.5f) / kBloomStep - 0.5f;
    const Tap ty = tap(small_y, small_.height);
    const Rgb *above = small_.row(ty.index), *below = small_.row(ty.index + ty.step);
    const auto expose = [&](float x, float noise) {
      const float root = std::sqrt(std::clamp(x * options_.exposure, 0.0f, kWhite) / kWhite) * last;
      const int i = std::min(static_cast<int>(root), static_cast<int>(curve_.size()) - 2);
      const std::size_t at = static_cast<std::size_t>(i);
      const float level = lerp(curve_[at], curve_[at + 1], root - static_cast<float>(i)) + noise;
      return static_cast<std::uint8_t>(std::clamp(static_cast<int>(level + 0.5f), 0, 255));
    };
    for (int x = 0; x < light.width; ++x) {
      Rgb c = in[x];
      if (bloom) {
        const Tap tx = tap((static_cast<float>(x) + 0.5f) / kBloomStep - 0.5f, small_.width);
        const Rgb far = mix(mix(above[tx.index], above[tx.index + tx.step], tx.weight),
                            mix(below[tx.index], below[tx.index + tx.step], tx.weight), ty.weight);
        c = c * kept + far * options_.bloom;
      }
      const std::uint32_t hash = scramble32(frame_key + static_cast<std::uint32_t>(y) * 0x8da6b343u +
                                            static_cast<std::uint32_t>(x) * 0xd8163841u);
      // The sum of two uniform draws of 16 bits is triangular.
      const float noise =
          options_.grain * (static_cast<float>(hash & 0xffff) + static_cast<float>(hash >> 16)) / 65536.0f -
          options_.grain;
      out[3 * x] = expose(c.b, noise);
      out[3 * x + 1] = expose(c.g, noise);
      out[3 * x + 2] = expose(c.r, noise);
    }
  });
}

}  // namespace freshet::synth::simulate
