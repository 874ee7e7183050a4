#include "synth/transfer/features.h"

#include <array>
#include <cassert>
#include <cmath>

#include "platform/vectors.h"
#if FRESHET_HAS_WIDE
#include <immintrin.h>
#endif

namespace freshet::synth::transfer {
namespace {

using Parts = PatchDistance::Parts;

constexpr int kNowChannels = 6;
constexpr double kAlphaWeight = 3;  // Eq. 9

std::int16_t level(float value, float scale) {
  return static_cast<std::int16_t>((value > 0.0f ? (value < 1.0f ? value : 1.0f) : 0.0f) * scale + 0.5f);
}

void put_picture(const PixelGrid& picture, int first, Features& to) {
  const float alpha_scale = kUnit * static_cast<float>(std::sqrt(kAlphaWeight));
  for_rows(picture.height, [&](int y) {
    std::int16_t* out = to.values.data() + static_cast<std::ptrdiff_t>(y) * to.width * kChannels + first;
    for (int x = 0; x < picture.width; ++x, out += kChannels) {
      const Pixel& pixel = picture(x, y);
      for (int c = 0; c < 3; ++c) out[c] = level(pixel.c[c], kUnit);
      out[3] = level(pixel.c[3], alpha_scale);
    }
  });
}

template <int kPatch>
Parts plain_parts(const std::int16_t* a, std::ptrdiff_t row_a, const std::int16_t* b, std::ptrdiff_t row_b) {
  Parts sum{0, 0};
  for (int y = 0; y < kPatch; ++y, a += row_a, b += row_b)
    for (int i = 0; i < kPatch * kChannels; ++i) {
      const int d = a[i] - b[i];
      (i % kChannels < kNowChannels ? sum.now : sum.previous) += d * d;
    }
  return sum;
}

#if FRESHET_HAS_WIDE

// Products of two neighbouring channels are added by one instruction, which the compiler finds only in sums
// that it closes row by row: 115 instructions per patch of 5 x 5 against 62 here.
// kept[lane]: all ones where the lane's two channels are of this frame, or of the one before.
template <int kPatch, bool kNow>
constexpr auto kept_lanes() {
  constexpr int kValues = kPatch * kChannels, kLanes = (kValues + 31) / 32 * 16;
  std::array<std::int32_t, kLanes> kept{};
  for (int lane = 0; lane < kLanes; ++lane)
    kept[static_cast<std::size_t>(lane)] =
        2 * lane < kValues && (2 * lane % kChannels < kNowChannels) == kNow ? -1 : 0;
  return kept;
}
template <int kPatch, bool kNow>
alignas(64) constexpr auto kKept = kept_lanes<kPatch, kNow>();

__attribute__((target("arch=x86-64-v3"))) inline Parts totals_256(const __m256i& now,
                                                                  const __m256i& previous) {
  const __m256i pairs = _mm256_hadd_epi32(now, previous);  // two of now's sums, two of previous', twice
  const __m128i halves = _mm_add_epi32(_mm256_castsi256_si128(pairs), _mm256_extracti128_si256(pairs, 1));
  const __m128i sums = _mm_hadd_epi32(halves, halves);
  return {_mm_extract_epi32(sums, 0), _mm_extract_epi32(sums, 1)};
}

template <int kPatch>
__attribute__((target("arch=x86-64-v4"))) Parts parts_512(const std::int16_t* a, std::ptrdiff_t row_a,
                                                          const std::int16_t* b, std::ptrdiff_t row_b) {
  constexpr int kVectors = (kPatch * kChannels + 31) / 32;
  __m512i sums[kVectors];
  for (__m512i& sum : sums) sum = _mm512_setzero_si512();
  for (int y = 0; y < kPatch; ++y, a += row_a, b += row_b)
    for (int i = 0; i < kVectors; ++i) {
      const __m512i d = _mm512_sub_epi16(_mm512_loadu_si512(a + 32 * i), _mm512_loadu_si512(b + 32 * i));
      sums[i] = _mm512_add_epi32(sums[i], _mm512_madd_epi16(d, d));
    }
  __m512i now = _mm512_setzero_si512(), previous = now;
  for (int i = 0; i < kVectors; ++i) {
    now = _mm512_add_epi32(now,
                           _mm512_and_si512(sums[i], _mm512_load_si512(kKept<kPatch, true>.data() + 16 * i)));
    previous = _mm512_add_epi32(
        previous, _mm512_and_si512(sums[i], _mm512_load_si512(kKept<kPatch, false>.data() + 16 * i)));
  }
  // gcc 12 warns of what its own header leaves unset in _mm512_extracti64x4_epi64.
  typedef long long Eight __attribute__((vector_size(64)));
  const Eight folded_now = reinterpret_cast<Eight>(now), folded_previous = reinterpret_cast<Eight>(previous);
  const __m256i now_halves[] = {
      reinterpret_cast<__m256i>(__builtin_shufflevector(folded_now, folded_now, 0, 1, 2, 3)),
      reinterpret_cast<__m256i>(__builtin_shufflevector(folded_now, folded_now, 4, 5, 6, 7))};
  const __m256i previous_halves[] = {
      reinterpret_cast<__m256i>(__builtin_shufflevector(folded_previous, folded_previous, 0, 1, 2, 3)),
      reinterpret_cast<__m256i>(__builtin_shufflevector(folded_previous, folded_previous, 4, 5, 6, 7))};
  return totals_256(_mm256_add_epi32(now_halves[0], now_halves[1]),
                    _mm256_add_epi32(previous_halves[0], previous_halves[1]));
}

template <int kPatch>
__attribute__((target("arch=x86-64-v3"))) Parts parts_256(const std::int16_t* a, std::ptrdiff_t row_a,
                                                          const std::int16_t* b, std::ptrdiff_t row_b) {
  constexpr int kVectors = (kPatch * kChannels + 15) / 16;
  __m256i sums[kVectors];
  for (__m256i& sum : sums) sum = _mm256_setzero_si256();
  for (int y = 0; y < kPatch; ++y, a += row_a, b += row_b)
    for (int i = 0; i < kVectors; ++i) {
      const __m256i d = _mm256_sub_epi16(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(a + 16 * i)),
                                         _mm256_loadu_si256(reinterpret_cast<const __m256i*>(b + 16 * i)));
      sums[i] = _mm256_add_epi32(sums[i], _mm256_madd_epi16(d, d));
    }
  __m256i now = _mm256_setzero_si256(), previous = now;
  for (int i = 0; i < kVectors; ++i) {
    const auto* kept_now = reinterpret_cast<const __m256i*>(kKept<kPatch, true>.data()) + i;
    const auto* kept_previous = reinterpret_cast<const __m256i*>(kKept<kPatch, false>.data()) + i;
    now = _mm256_add_epi32(now, _mm256_and_si256(sums[i], _mm256_load_si256(kept_now)));
    previous = _mm256_add_epi32(previous, _mm256_and_si256(sums[i], _mm256_load_si256(kept_previous)));
  }
  return totals_256(now, previous);
}

template <int kPatch>
Parts parts_128(const std::int16_t* a, std::ptrdiff_t row_a, const std::int16_t* b, std::ptrdiff_t row_b) {
  constexpr int kVectors = (kPatch * kChannels + 7) / 8;
  __m128i sums[kVectors];
  for (__m128i& sum : sums) sum = _mm_setzero_si128();
  for (int y = 0; y < kPatch; ++y, a += row_a, b += row_b)
    for (int i = 0; i < kVectors; ++i) {
      const __m128i d = _mm_sub_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(a + 8 * i)),
                                      _mm_loadu_si128(reinterpret_cast<const __m128i*>(b + 8 * i)));
      sums[i] = _mm_add_epi32(sums[i], _mm_madd_epi16(d, d));
    }
  Parts total{0, 0};
  for (int i = 0; i < kVectors; ++i) {
    alignas(16) std::int32_t lanes[4];
    _mm_store_si128(reinterpret_cast<__m128i*>(lanes), sums[i]);
    for (int lane = 0; lane < 4; ++lane) {
      const std::size_t at = static_cast<std::size_t>(4 * i + lane);
      total.now += lanes[lane] & kKept<kPatch, true>[at];
      total.previous += lanes[lane] & kKept<kPatch, false>[at];
    }
  }
  return total;
}

#endif

template <int kPatch>
PatchDistance::Kernel kernel_of(int vector_bytes) {
#if FRESHET_HAS_WIDE
  if (vector_bytes >= 64) return parts_512<kPatch>;
  if (vector_bytes >= 32) return parts_256<kPatch>;
  if (vector_bytes >= 16) return parts_128<kPatch>;
#endif
  static_cast<void>(vector_bytes);
  return plain_parts<kPatch>;
}

}  // namespace

Features::Features(int w, int h)
    : width(w),
      height(h),
      values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h) * kChannels + 64) {}

void put_now(const PixelGrid& now, Features& to) { put_picture(now, 0, to); }
void put_previous(const PixelGrid& previous, Features& to) { put_picture(previous, kNowChannels, to); }

void put_blurred_alpha(const Grid& blurred_alpha, double eta, Features& to) {
  const float scale = kUnit * static_cast<float>(std::sqrt(eta));
  for (std::size_t i = 0; i < blurred_alpha.values.size(); ++i)
    to.values[i * kChannels + 4] = level(blurred_alpha.values[i], scale);
}

Guides guides_of(const Grid& alpha, const VectorGrid& flow, const TransferOptions& options) {
  const double scale = 2 * options.radius;
  return {curvature(blurred(alpha, scale), scale), divergence(flow, alpha, scale)};
}

void put_guides(const Guides& guides, const TransferOptions& options, Features& to) {
  const auto side = static_cast<float>(options.patch);
  const float curvature = side * static_cast<float>(std::sqrt(options.curvature)),
              divergence = side * static_cast<float>(std::sqrt(options.divergence));
  to.guides.resize(guides.curvature.values.size());
  for (std::size_t i = 0; i < to.guides.size(); ++i)
    to.guides[i] = {curvature * guides.curvature.values[i], divergence * guides.divergence.values[i]};
}

PatchDistance::Kernel PatchDistance::kernel(int patch, int vector_bytes) {
  switch (patch) {
    case 3:
      return kernel_of<3>(vector_bytes);
    case 7:
      return kernel_of<7>(vector_bytes);
    case 9:
      return kernel_of<9>(vector_bytes);
    default:
      return kernel_of<5>(vector_bytes);
  }
}

PatchDistance::PatchDistance(const Features& source, const Features& target, const std::vector<float>& lambda,
                             int patch)
    : side_(patch),
      source_row_(static_cast<std::ptrdiff_t>(source.width) * kChannels),
      target_row_(static_cast<std::ptrdiff_t>(target.width) * kChannels),
      lambda_(lambda.data()),
      source_guides_(source.guides.empty() ? nullptr : source.guides.data()),
      target_guides_(target.guides.empty() ? nullptr : target.guides.data()),
      kernel_(kernel(patch, vector_bytes())) {
  assert(source.guides.empty() == target.guides.empty());
  const std::ptrdiff_t half = patch / 2;
  source_ = source.values.data() - half * (source_row_ + kChannels);
  target_ = target.values.data() - half * (target_row_ + kChannels);
}

}  // namespace freshet::synth::transfer
