#include "store/codec/block_predictor.h"

#include <algorithm>

#include "platform/vectors.h"

// Vectors of 32 bytes are handed about below, by functions that are always inlined: no ABI is met.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace freshet::store {
namespace {

constexpr std::size_t kLanes = kBlock;
constexpr std::size_t kLead = 2;  // diagonals in front of a strip's first

// ---- The encoder: rows.

// One row of residuals under each predictor, and what they add to the columns' costs. A row is preceded by
// the sample above its first.
template <class Sample, class Wide, class Cost>
[[gnu::always_inline]] inline void predict_row(const Wide* now, const Wide* before, std::ptrdiff_t pitch,
                                               std::size_t width, std::size_t apart, Sample* residuals,
                                               std::size_t costs_apart, Cost* costs) {
  constexpr int kTop = sizeof(Sample) * 8 - 1;
  const auto med = [](Wide w, Wide n, Wide nw) {
    const Wide low = std::min(w, n), high = std::max(w, n);
    return std::max(low, std::min(high, static_cast<Wide>(w + n - nw)));
  };
#pragma GCC ivdep
  for (std::ptrdiff_t x = 0; x < static_cast<std::ptrdiff_t>(width); ++x) {
    const Wide w = now[x - 1], n = (now - pitch)[x], nw = (now - pitch - 1)[x];
    const Wide p = before[x];
    const Wide dw = static_cast<Wide>(w - before[x - 1]), dn = static_cast<Wide>(n - (before - pitch)[x]),
               dnw = static_cast<Wide>(nw - (before - pitch - 1)[x]);
    const Wide spatial = med(w, n, nw);
    const Wide predicted[kPredictors] = {spatial, p, static_cast<Wide>(p + med(dw, dn, dnw)),
                                         static_cast<Wide>(static_cast<Wide>(3 * (w + n) - 2 * nw + 2) >> 2),
                                         static_cast<Wide>(static_cast<Wide>(spatial + p) >> 1)};
#pragma GCC unroll 5
    for (std::size_t k = 0; k < kPredictors; ++k) {
      const auto e = static_cast<std::make_signed_t<Sample>>(now[x] - predicted[k]);
      const auto z = static_cast<Sample>(static_cast<Sample>(e << 1) ^ static_cast<Sample>(e >> kTop));
      residuals[k * apart + static_cast<std::size_t>(x)] = z;
      Cost& cost = costs[k * costs_apart + static_cast<std::size_t>(x)];
      cost = static_cast<Cost>(cost + z);
    }
  }
}

FRESHET_WIDE void predict_rows(const std::int16_t* now, const std::int16_t* before, std::ptrdiff_t pitch,
                               std::size_t width, std::size_t rows, std::size_t residual_pitch,
                               std::uint8_t* residuals, std::uint16_t* costs) {
  for (std::size_t y = 0; y < rows; ++y, now += pitch, before += pitch, residuals += residual_pitch) {
    predict_row<std::uint8_t>(now, before, pitch, width, kBlock * residual_pitch, residuals, residual_pitch,
                              costs);
  }
}

FRESHET_WIDE void predict_rows(const std::int32_t* now, const std::int32_t* before, std::ptrdiff_t pitch,
                               std::size_t width, std::size_t rows, std::size_t residual_pitch,
                               std::uint16_t* residuals, std::uint32_t* costs) {
  for (std::size_t y = 0; y < rows; ++y, now += pitch, before += pitch, residuals += residual_pitch) {
    predict_row<std::uint16_t>(now, before, pitch, width, kBlock * residual_pitch, residuals, residual_pitch,
                               costs);
  }
}

// ---- The decoder: diagonals.

// A strip lies as diagonals of 8 lanes: lane i of diagonal t is the sample of row i and column t - i. Column
// -1 of a row holds the sample above the row's first, which is what stands to the left of that. Lanes outside
// the tile hold anything; nothing inside is predicted from them.
template <class T>
using Lanes [[gnu::vector_size(kLanes * sizeof(T))]] = T;

template <class T>
[[gnu::always_inline]] inline Lanes<T> load_lanes(const T* from) {
  Lanes<T> lanes;
  __builtin_memcpy(&lanes, from, sizeof lanes);
  return lanes;
}

template <class Vector, class T>
[[gnu::always_inline]] inline void store_lanes(const Vector& lanes, T* to) {
  static_assert(sizeof lanes == kLanes * sizeof(T));
  __builtin_memcpy(to, &lanes, sizeof lanes);
}

// Lane i of 8 vectors becomes vector i: three perfect shuffles.
template <class T>
[[gnu::always_inline]] inline void transpose(Lanes<T> (&v)[kLanes]) {
  for (int stage = 0; stage < 3; ++stage) {
    Lanes<T> mixed[kLanes];
#pragma GCC unroll 4
    for (int i = 0; i < 4; ++i) {
      mixed[2 * i] = __builtin_shufflevector(v[i], v[i + 4], 0, 8, 1, 9, 2, 10, 3, 11);
      mixed[2 * i + 1] = __builtin_shufflevector(v[i], v[i + 4], 4, 12, 5, 13, 6, 14, 7, 15);
    }
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kLanes; ++i) v[i] = mixed[i];
  }
}

// Lane i is lane i - 1 of `lanes`, and lane 0 the last one of `first`.
template <class T>
[[gnu::always_inline]] inline Lanes<T> shift_in(const Lanes<T>& first, const Lanes<T>& lanes) {
  return __builtin_shufflevector(first, lanes, 7, 8, 9, 10, 11, 12, 13, 14);
}

/// Where a strip of the frame in hand lies, that above it, and both in the frame before.
template <class Wide>
struct Strips {
  Wide* now;
  const Wide *above, *before, *before_above;
};

// 8 diagonals a turn: lane i of turn b takes up to i samples of block b - 1 and the rest of block b.
template <class Sample, class Wide>
[[gnu::always_inline]] inline void restore_lanes(const Strips<Wide>& strips, const Predictor* choices,
                                                 std::size_t blocks, std::size_t pitch,
                                                 const Sample* residuals, Sample* restored) {
  using Vector = Lanes<Wide>;
  constexpr Wide kMask = static_cast<Wide>((1 << (8 * sizeof(Sample) - 1)) * 2 - 1);
  const auto all_if = [](bool yes) {
    const auto lane = static_cast<Wide>(yes ? -1 : 0);
    return Vector{lane, lane, lane, lane, lane, lane, lane, lane};
  };
  const auto min_of = [](const Vector& a, const Vector& b) { return a < b ? a : b; };
  const auto max_of = [](const Vector& a, const Vector& b) { return a > b ? a : b; };
  Vector lane_number;
  for (std::size_t i = 0; i < kLanes; ++i) lane_number[i] = static_cast<Wide>(i);

  // What is left of the first row's first sample is the one above that.
  const Vector corner = load_lanes(strips.above + (kLanes - 1) * kLanes);
  Vector last = Vector{} + corner[kLanes - 1], last_but_one{};
  store_lanes(last, strips.now - kLanes);
  Vector drift_before{}, plain_before{}, soft_before{}, mean_before{};
  for (std::size_t b = 0; b <= blocks; ++b) {
    const Predictor kind = choices[std::min(b, blocks - 1)];
    const Vector drift_here = all_if(kind == Predictor::kDrift),
                 plain_here = all_if(kind == Predictor::kTemporal || kind == Predictor::kCopy),
                 soft_here = all_if(kind == Predictor::kSoft), mean_here = all_if(kind == Predictor::kMean);
    Vector e[kLanes], value[kLanes];
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kLanes; ++i) {
      const Sample* from = residuals + i * pitch + b * kBlock - i;
      Vector z;
#pragma GCC unroll 8
      for (std::size_t k = 0; k < kLanes; ++k) z[k] = static_cast<Wide>(from[k]);
      e[i] = (z >> 1) ^ -(z & 1);
    }
    transpose<Wide>(e);
#pragma GCC unroll 8
    for (std::size_t j = 0; j < kLanes; ++j) {
      const std::size_t t = (b * kBlock + j) * kLanes;
      const Vector here = lane_number <= static_cast<Wide>(j);
      const Vector drift = here ? drift_here : drift_before, plain = here ? plain_here : plain_before,
                   soft = here ? soft_here : soft_before, mean = here ? mean_here : mean_before;
      const Vector n_raw = shift_in<Wide>(load_lanes(strips.above + t + 7 * kLanes), last),
                   nw_raw = shift_in<Wide>(load_lanes(strips.above + t + 6 * kLanes), last_but_one);
      const Vector pw = load_lanes(strips.before + t - kLanes), p = load_lanes(strips.before + t);
      const Vector pn = shift_in<Wide>(load_lanes(strips.before_above + t + 7 * kLanes), pw),
                   pnw = shift_in<Wide>(load_lanes(strips.before_above + t + 6 * kLanes),
                                        load_lanes(strips.before + t - 2 * kLanes));
      const Vector w = last - (pw & drift), n = n_raw - (pn & drift), nw = nw_raw - (pnw & drift);
      const Vector med = max_of(min_of(w, n), min_of(max_of(w, n), w + n - nw));
      const Vector weighted = (3 * (w + n) - 2 * nw + 2) >> 2;
      Vector predicted = (soft ? weighted : med) & ~plain;
      predicted += p & (drift | plain | mean);
      predicted = mean ? predicted >> 1 : predicted;
      last_but_one = last;
      last = (predicted + e[j]) & kMask;
      if (b == 0 && j + 1 < kLanes) {  // column -1 of row j + 1
        const Vector border = lane_number == static_cast<Wide>(j + 1);
        last = border ? shift_in<Wide>(last, last) : last;
      }
      store_lanes(last, strips.now + t);
      value[j] = last;
    }
    transpose<Wide>(value);
#pragma GCC unroll 8
    for (std::size_t i = 0; i < kLanes; ++i) {
      Sample* to = restored + i * pitch + b * kBlock - i;
      const Lanes<Sample> narrow = __builtin_convertvector(value[i], Lanes<Sample>);
      store_lanes(narrow, to);
    }
    drift_before = drift_here, plain_before = plain_here, soft_before = soft_here, mean_before = mean_here;
  }
}

FRESHET_WIDE void restore_strip(const Strips<std::int16_t>& strips, const Predictor* choices,
                                std::size_t blocks, std::size_t pitch, const std::uint8_t* residuals,
                                std::uint8_t* restored) {
  restore_lanes(strips, choices, blocks, pitch, residuals, restored);
}

FRESHET_WIDE void restore_strip(const Strips<std::int32_t>& strips, const Predictor* choices,
                                std::size_t blocks, std::size_t pitch, const std::uint16_t* residuals,
                                std::uint16_t* restored) {
  restore_lanes(strips, choices, blocks, pitch, residuals, restored);
}

std::size_t blocks_of(std::uint32_t samples) { return (samples + kBlock - 1) / kBlock; }

}  // namespace

template <class Sample>
void StripPredictor<Sample>::begin(std::uint32_t width, std::uint32_t height) {
  width_ = width;
  height_ = height;
  pitch_ = std::size_t{width} + 1;
  for (auto& frame : frames_) frame.assign(pitch_ * (std::size_t{height} + 1), 0);
  candidates_.resize(kPredictors * kBlock * pitch_);
  best_.resize(kBlock * pitch_);
  costs_.resize(kPredictors * pitch_);
}

template <class Sample>
void StripPredictor<Sample>::next_frame(std::span<const Sample> samples, Sample turn) {
  now_ ^= 1;
  Wide* row = frames_[now_].data() + pitch_;
  for (std::size_t y = 0; y < height_; ++y, row += pitch_) {
    const Sample* from = samples.data() + y * width_;
    row[0] = *(row + 1 - pitch_);
    for (std::size_t x = 0; x < width_; ++x) row[x + 1] = static_cast<Sample>(from[x] ^ turn);
  }
}

template <class Sample>
void StripPredictor<Sample>::predict(std::uint32_t strip, std::span<Predictor> choices) {
  const std::size_t y = std::size_t{strip} * kBlock, rows = std::min<std::size_t>(kBlock, height_ - y);
  const std::size_t first = (y + 1) * pitch_ + 1;
  std::ranges::fill(costs_, Cost{0});
  predict_rows(frames_[now_].data() + first, frames_[now_ ^ 1].data() + first,
               static_cast<std::ptrdiff_t>(pitch_), width_, rows, pitch_, candidates_.data(), costs_.data());
  for (std::size_t b = 0; b < choices.size(); ++b) {
    const std::size_t x = b * kBlock, count = std::min<std::size_t>(kBlock, width_ - x);
    std::array<std::uint32_t, kPredictors> cost{};
    for (std::size_t k = 0; k < kPredictors; ++k) {
      for (std::size_t i = 0; i < count; ++i) cost[k] += costs_[k * pitch_ + x + i];
    }
    const auto kind = static_cast<std::size_t>(std::ranges::min_element(cost) - cost.begin());
    const Sample* from = candidates_.data() + kind * kBlock * pitch_ + x;
    for (std::size_t row = 0; row < rows; ++row) {
      std::copy_n(from + row * pitch_, count, best_.data() + row * pitch_ + x);
    }
    choices[b] =
        cost[static_cast<std::size_t>(Predictor::kTemporal)] == 0 ? Predictor::kCopy : Predictor(kind);
  }
}

template <class Sample>
void StripRestorer<Sample>::begin(std::uint32_t width, std::uint32_t height) {
  const std::size_t blocks = blocks_of(width);
  pitch_ = (blocks + 2) * kBlock;
  // A strip is read up to 7 diagonals beyond the last that it has itself.
  strip_ = (kLead + (blocks + 2) * kBlock) * kLanes;
  for (auto& frame : frames_) frame.assign((blocks_of(height) + 1) * strip_, 0);
  residuals_.assign(kBlock * pitch_, 0);
  restored_.resize(kBlock * pitch_);
}

template <class Sample>
void StripRestorer<Sample>::next_frame() {
  now_ ^= 1;
}

template <class Sample>
void StripRestorer<Sample>::restore(std::uint32_t strip, std::span<const Predictor> choices) {
  const std::size_t above = strip * strip_ + kLead * kLanes, here = above + strip_;
  Wide* now = frames_[now_].data();
  const Wide* before = frames_[now_ ^ 1].data();
  restore_strip({now + here, now + above, before + here, before + above}, choices.data(), choices.size(),
                pitch_, residuals(0), restored_.data() + kBlock);
}

template class StripPredictor<std::uint8_t>;
template class StripPredictor<std::uint16_t>;
template class StripRestorer<std::uint8_t>;
template class StripRestorer<std::uint16_t>;

}  // namespace freshet::store
