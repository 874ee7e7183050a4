// synth/transfer/features.h — the nine weighted channels of a pixel, and the distance of two patches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "synth/transfer/pixel_grid.h"
#include "synth/transfer/transfer.h"

namespace freshet::synth::transfer {

/// Channels of Eq. 8, times the roots of their weights of Eq. 9 and 1023, as 16-bit integers: blue, green,
/// red, alpha, blurred alpha, 0, then blue, green, red and alpha of the frame before.
///
/// Integers, because their sums are the same in any order: vectors of any width give the same bits. And
/// because they are half the bytes of floats: a patch of 5 x 5 is five runs of 100 bytes. 1023 leaves 10-bit
/// pictures whole, and the largest sum (patch 9, eta 16) is 1.9e9.
inline constexpr int kChannels = 10;
inline constexpr float kUnit = 1023.0f;

struct Features {
  int width = 0, height = 0;
  std::vector<std::int16_t> values;  // row-major, and 64 more, which the widest read runs into
  /// By pixel: Guides, times the roots of their weights; empty: none.
  std::vector<Vec2> guides;

  Features() = default;
  Features(int w, int h);
};

void put_now(const PixelGrid& now, Features& to);
void put_blurred_alpha(const Grid& blurred_alpha, double eta, Features& to);
void put_previous(const PixelGrid& previous, Features& to);

/// What a patch's centre is compared by beside Eq. 9, -1..1: the outline's curvature, the flow's divergence (Sec. 6).
struct Guides {
  Grid curvature, divergence;
};
inline bool guided(const TransferOptions& options) { return options.curvature > 0 || options.divergence > 0; }
/// At a scale of twice the radius: finer bends of an outline are in its alpha.
///
/// flow  px a frame, of alpha's size.
Guides guides_of(const Grid& alpha, const VectorGrid& flow, const TransferOptions& options);
/// Weights are of a pixel's channel, as eta is: the centre's guides count as those of all pixels of its patch.
void put_guides(const Guides& guides, const TransferOptions& options, Features& to);

/// D of Eq. 9, and of the guides: both pictures have them, or neither.
class PatchDistance {
 public:
  /// lambda  one per target pixel: a patch has that of its centre. All outlive this.
  PatchDistance(const Features& source, const Features& target, const std::vector<float>& lambda, int patch);

  /// Indices of patch centres, y * width + x, no nearer to an edge than patch / 2. In colours of 0..1.
  float operator()(int source, int target) const {
    const Parts parts = kernel_(source_ + static_cast<std::ptrdiff_t>(source) * kChannels, source_row_,
                                target_ + static_cast<std::ptrdiff_t>(target) * kChannels, target_row_);
    const float distance =
        (static_cast<float>(parts.now) + lambda_[target] * static_cast<float>(parts.previous)) *
        (1.0f / (kUnit * kUnit));
    if (source_guides_ == nullptr) return distance;
    const Vec2 a = source_guides_[source], b = target_guides_[target];
    return distance + ((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y));
  }

  /// Begins to read a patch from memory that will be compared soon.
  void prefetch_source(int source) const { prefetch(source_, source, source_row_); }
  void prefetch_target(int target) const { prefetch(target_, target, target_row_); }

  struct Parts {
    std::int32_t now, previous;
  };
  using Kernel = Parts (*)(const std::int16_t* a, std::ptrdiff_t row_a, const std::int16_t* b,
                           std::ptrdiff_t row_b);
  /// From top-left corners; rows in values. vector_bytes: 0 for plain loops, 16, 32, 64.
  static Kernel kernel(int patch, int vector_bytes);

 private:
  void prefetch(const std::int16_t* values, int patch, std::ptrdiff_t row) const {
    values += static_cast<std::ptrdiff_t>(patch) * kChannels;
    for (int y = 0; y < side_; ++y, values += row) {
      __builtin_prefetch(values);
      __builtin_prefetch(values + side_ * kChannels - 1);
    }
  }

  int side_;
  const std::int16_t *source_, *target_;  // of index 0's patch, which is never read
  std::ptrdiff_t source_row_, target_row_;
  const float* lambda_;
  const Vec2 *source_guides_, *target_guides_;  // null: none
  Kernel kernel_;
};

}  // namespace freshet::synth::transfer
