#include "synth/animate/still/carried_base.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <type_traits>

#include <opencv2/imgproc.hpp>

#include "platform/vectors.h"
#include "synth/sampling/cells.h"
#include "synth/sampling/cubic.h"
#include "synth/sampling/remapped.h"

namespace freshet::synth::animate {
namespace {

constexpr double kMinDepth = 0.02;
constexpr double kDeep = 3;          // times the width that copies fade over: from there on no edge is near
constexpr float kMinWeight = 1e-3f;  // of a place that anything is carried to
constexpr float kEnough = 4;         // of a place's weight, a quarter may be brought: from near an edge, say
// Times a place's own weight: what comes from deeper in the fluid counts no more. A hundred times would let a copy that
// hardly shows take over thin fluid, in squares of its map's samples.
constexpr float kDeeper = 4;
constexpr float kMinShare = 1.0f / 8192;  // of a copy, anywhere in a cell
constexpr float kMinMass = 1e-4f;         // so that values are there also where none of it is fluid
constexpr int kCellWidth = 32, kCellHeight = 16, kCellArea = kCellWidth * kCellHeight;
constexpr int kLeastStep = 4, kMostStep = 16;
// Of a map: columns around a cell, from one before it, and what it is continued by to the right, at most.
constexpr int across_cell(int step) { return kCellWidth / step + 2; }
constexpr int kAfter = across_cell(kLeastStep) - 1;
constexpr int kBlock = 8;   // px, in which it is told whether all is fluid
constexpr int kMargin = 4;  // samples around the planes: of what is read at once, two beyond a picture's edge

struct Range {
  float least, most;
};

// Calls with the step as a constant.
template <class Function>
[[gnu::always_inline]] inline auto for_step(int step, const Function& function) {
  switch (step) {
    case 16:
      return function(std::integral_constant<int, 16>());
    case 8:
      return function(std::integral_constant<int, 8>());
    default:
      return function(std::integral_constant<int, 4>());
  }
}

template <int kStep>
[[gnu::always_inline]] inline Range range_at(const float* map, std::ptrdiff_t stride, int rows) {
  constexpr int kAcross = across_cell(kStep);
  std::array<float, kAcross> least, most;
  for (int x = 0; x < kAcross; ++x) least[x] = most[x] = map[x];
  for (int y = 1; y < rows; ++y)
    for (int x = 0; x < kAcross; ++x) {
      const float at = map[y * stride + x];
      least[x] = at < least[x] ? at : least[x];
      most[x] = at > most[x] ? at : most[x];
    }
  for (int n = kAcross; n > 1; n = (n + 1) / 2)
    for (int x = 0, half = (n + 1) / 2; x + half < n; ++x) {
      const int other = x + half;
      least[x] = least[other] < least[x] ? least[other] : least[x];
      most[x] = most[other] > most[x] ? most[other] : most[x];
    }
  return {least[0], most[0]};
}

// Of a map's samples around a cell.
FRESHET_WIDE Range range_of(const float* map, std::ptrdiff_t stride, int rows, int step) {
  return for_step(
      step, [&](auto constant) __attribute__((always_inline)) {
        return range_at<decltype(constant)::value>(map, stride, rows);
      });
}

template <int kStep>
[[gnu::always_inline]] inline void widen_at(const float* map, std::ptrdiff_t stride, const std::int32_t* rows,
                                            const float* down, const cv::Rect& cell, float* out) {
  constexpr int kGroups = kCellWidth / kStep, kAcross = across_cell(kStep), kHalf = kStep / 2;
  for (int y = 0; y < cell.height; ++y, out += cell.width) {
    const float *upper = map + (rows[y] - rows[0]) * stride, *lower = upper + stride;
    std::array<float, kAcross> mixed;
    for (int x = 0; x < kAcross; ++x) mixed[x] = upper[x] + down[y] * (lower[x] - upper[x]);
    for (int k = 0; k < kGroups; ++k) {
      const float before = mixed[k + 1] - mixed[k], after = mixed[k + 2] - mixed[k + 1];
      for (int i = 0; i < kHalf; ++i) {
        const float beyond = (static_cast<float>(i) + 0.5f) / kStep;  // the middle between two samples
        out[kStep * k + i] = mixed[k] + (0.5f + beyond) * before;
        out[kStep * k + kHalf + i] = mixed[k + 1] + beyond * after;
      }
    }
  }
}

// A map at a cell's places: between two of its rows, then `step` between each two samples. rows, down: by row of the
// cell, the map's before it and how far it lies beyond that. Up to a cell's whole width is written, which the next row
// overwrites.
FRESHET_WIDE void widen(const float* map, std::ptrdiff_t stride, const std::int32_t* rows, const float* down,
                        const cv::Rect& cell, int step, float* out) {
  for_step(
      step, [&](auto constant) __attribute__((always_inline)) {
        widen_at<decltype(constant)::value>(map, stride, rows, down, cell, out);
      });
}

[[gnu::always_inline]] inline std::int32_t steps_of(float at) {
  return static_cast<std::int32_t>(at * sampling::kCubicSteps + (2 * sampling::kCubicSteps + 0.5f)) -
         2 * sampling::kCubicSteps;
}

// Sources of a row's places, in steps (cubic.h) of the planes: `away` from their own, origin + step i. inside: none of
// them needs to be looked for beyond the picture.
FRESHET_WIDE void sources(const float* away, int origin, int step, const sampling::Span& picture, bool inside,
                          std::int32_t* out) {
  if (inside) {
#pragma GCC ivdep
    for (int i = 0; i < kCellWidth; ++i) out[i] = steps_of(static_cast<float>(origin + step * i) + away[i]);
    return;
  }
#pragma GCC ivdep
  for (int i = 0; i < kCellWidth; ++i) {
    const auto own = static_cast<float>(origin + step * i);
    out[i] = steps_of(sampling::carried_from(own + away[i], own, picture));
  }
}

// The same for squares of two by two places, in steps of a plane at half size.
FRESHET_WIDE void half_sources(const std::int32_t* upper, const std::int32_t* lower, int n,
                               std::int32_t* out) {
  for (int i = 0; i < n; ++i) {
    const std::int32_t sum = upper[2 * i] + upper[2 * i + 1] + lower[2 * i] + lower[2 * i + 1];
    out[i] = (((sum >> 2) + sampling::kCubicSteps / 2) >> 1) - sampling::kCubicSteps / 2;
  }
}

FRESHET_WIDE void read(const float* plane, std::ptrdiff_t offset, std::ptrdiff_t stride,
                       const std::int32_t* x, const std::int32_t* y, int n, float* out) {
  sampling::cubic(plane, offset, stride, x, y, n, out);
}

FRESHET_WIDE void add_copy(const float* luma, const float* weight, const float* most, const float* share,
                           int n, float* sum, float* mass) {
  for (int i = 0; i < n; ++i) {
    const float own = share[i] * std::max(std::min(weight[i], most[i]), kMinMass);
    sum[i] += own * luma[i];
    mass[i] += own;
  }
}

// Fours read bilinearly: sums of blue, red and weight, the first two each times its weight.
FRESHET_WIDE void add_colours(const float* plane, std::ptrdiff_t offset, std::ptrdiff_t stride,
                              const std::int32_t* x, const std::int32_t* y, const float* most,
                              const float* share, int n, float* sums) {
  typedef float Quad __attribute__((vector_size(16)));
  for (int i = 0; i < n; ++i) {
    const auto* from = reinterpret_cast<const Quad*>(plane) + offset +
                       (y[i] >> sampling::kCubicShift) * stride + (x[i] >> sampling::kCubicShift);
    const float fx = static_cast<float>(x[i] & (sampling::kCubicSteps - 1)) / sampling::kCubicSteps;
    const float fy = static_cast<float>(y[i] & (sampling::kCubicSteps - 1)) / sampling::kCubicSteps;
    const Quad upper = from[0] + fx * (from[1] - from[0]);
    const Quad lower = from[stride] + fx * (from[stride + 1] - from[stride]);
    Quad own = upper + fy * (lower - upper);
    const float weight = share[i] * std::min(own[2], most[i]);
    own[2] = 1;
    *reinterpret_cast<Quad*>(sums + 4 * i) += own * weight;
  }
}

[[gnu::always_inline]] inline std::int16_t packed(float value) {
  constexpr int kRange = 1 << 15;
  const float inside = std::min(std::max(value, -1.9f), 1.9f);
  return static_cast<std::int16_t>(static_cast<int>(inside * CarriedFrame::kOne + (kRange + 0.5f)) - kRange);
}

FRESHET_WIDE void pack_luma(const float* sum, const float* mass, int n, std::int16_t* out) {
  for (int i = 0; i < n; ++i) out[i] = packed(sum[i] / mass[i]);
}

FRESHET_WIDE void pack_colours(const float* sums, float max_fraction, const float* own, int n,
                               std::int16_t* blue, std::int16_t* red, std::int16_t* fraction) {
  for (int i = 0; i < n; ++i) {
    const float mass = sums[4 * i + 2], whole = mass > 0 ? 1 / mass : 0.0f;
    blue[i] = packed(sums[4 * i] * whole);
    red[i] = packed(sums[4 * i + 1] * whole);
    // What is brought is fluid as far as this place itself is.
    fraction[i] = packed(own[i] > kMinWeight ? max_fraction * std::min(kEnough * mass / own[i], 1.0f) : 0.0f);
  }
}

// Twice as many values between samples: output 2 i lies a quarter before sample i, 2 i + 1 a quarter after
// it.
FRESHET_WIDE void twice(const std::int16_t* near, const std::int16_t* far, int n, int width, float* line,
                        float* out) {
  constexpr float kUnit = 1.0f / CarriedFrame::kOne;
  for (int i = 0; i < n; ++i)
    line[i + 1] = kUnit * (0.75f * static_cast<float>(near[i]) + 0.25f * static_cast<float>(far[i]));
  line[0] = line[1];
  line[n + 1] = line[n];
  const int pairs = width / 2;
  for (int i = 0; i < pairs; ++i) {
    out[2 * i] = 0.25f * line[i] + 0.75f * line[i + 1];
    out[2 * i + 1] = 0.75f * line[i + 1] + 0.25f * line[i + 2];
  }
  if (width % 2 != 0) out[width - 1] = 0.25f * line[pairs] + 0.75f * line[pairs + 1];
}

FRESHET_WIDE void lay_over(const std::int16_t* luma, const float* fraction, const float* still, int n,
                           float* out) {
  constexpr float kUnit = 1.0f / CarriedFrame::kOne;
  for (int i = 0; i < n; ++i)
    out[i] = still[i] + fraction[i] * (kUnit * static_cast<float>(luma[i]) - still[i]);
}

/// Whether a cell's sources on one axis need not be looked for beyond the picture. away: from their own.
bool within(const Range& away, int first, int length, const sampling::Span& picture) {
  const float rim = (picture.end - picture.first) / sampling::kRims;
  return static_cast<float>(first) + away.least >= picture.first + rim &&
         static_cast<float>(first + length - 1) + away.most < picture.end - rim - 1;
}

/// Samples of a plane with its margin that are read for such a cell.
cv::Rect reached(const cv::Rect& cell, const Range& x, const Range& y) {
  constexpr int kBeside = 3;
  const cv::Point from(cvFloor(x.least) - kBeside, cvFloor(y.least) - kBeside),
      to(cvCeil(x.most) + kBeside, cvCeil(y.most) + kBeside);
  return {cell.tl() + from + cv::Point(kMargin, kMargin), cell.br() + to + cv::Point(kMargin, kMargin)};
}

}  // namespace

struct CarriedBase::Scratch {
  std::array<std::int32_t, kCellArea> x, y, half_x, half_y;
  std::array<float, kCellArea> luma, weight, share, half_share, sum, mass;
  std::array<float, kCellArea> most, half_most;      // weight that counts
  alignas(16) std::array<float, kCellArea> colours;  // fours, of a quarter as many places
  std::array<float, kCellArea> u, v;                 // how far away a copy's places lie
};

int step_of_maps(double piece_scale) {
  int step = kLeastStep;
  while (step < kMostStep && 6 * step <= 16 * piece_scale) step *= 2;
  return step;
}

CarriedBase::CarriedBase(const ContinuedFluid& fluid, const CarriedBaseOptions& options,
                         const cv::Mat& texture)
    : fraction_(static_cast<float>(options.fraction)),
      carries_colour_(texture.empty()),
      step_(options.step),
      picture_(fluid.picture),
      size_(picture_.size()),
      half_((size_.width + 1) / 2, (size_.height + 1) / 2) {
  const FluidPlanes& planes = fluid.planes;
  const cv::Mat& matte = fluid.matte;
  // Copies fade towards the matte's edge: carried on, it would go through the fluid as a line. At the picture's the
  // fluid goes on.
  cv::Mat depth;
  cv::distanceTransform(matte > 0.5, depth, cv::DIST_L2, cv::DIST_MASK_5);
  depth /= std::max(options.edge_px, 1.0);
  const cv::Mat weight = matte.mul(cv::min(cv::max(depth, kMinDepth), 1.0));

  for (const cv::Rect& cell : sampling::cells_touched(std::vector{cv::Rect({}, size_)}, cv::Rect({}, size_),
                                                      {kCellWidth, kCellHeight})) {
    // Fractions are read between samples: what is next to a cell reaches into it.
    const cv::Rect around =
        cv::Rect(cell.x - 2, cell.y - 2, cell.width + 4, cell.height + 4) & cv::Rect({}, size_);
    double maximum = 0;
    cv::minMaxLoc(weight(around + picture_.tl()), nullptr, &maximum);
    if (maximum > 0) cells_.push_back(cell);
  }

  const std::array<cv::Mat, 3> plane{planes.luma, planes.blue, planes.red};
  const auto with_margin = [](const cv::Mat& of, int after) {
    cv::Mat wider;
    cv::copyMakeBorder(of, wider, kMargin, kMargin + after, kMargin, kMargin + after, cv::BORDER_REFLECT);
    return wider;
  };
  luma_ = with_margin(carries_colour_ ? plane[0] : texture, 0);
  weight_ = with_margin(weight, 0);
  const cv::Size blocks((weight_.cols + kBlock - 1) / kBlock, (weight_.rows + kBlock - 1) / kBlock);
  cv::Mat faded;
  cv::copyMakeBorder(weight_ < 1, faded, 0, kBlock * blocks.height - weight_.rows, 0,
                     kBlock * blocks.width - weight_.cols, cv::BORDER_REPLICATE);
  cv::resize(faded, faded, blocks, 0, 0, cv::INTER_AREA);
  cv::integral(faded > 0, faded_, CV_32S);
  const auto halved = [](const cv::Mat& of) {
    // Odd sizes end in half a sample: the edge goes on.
    cv::Mat even, out;
    cv::copyMakeBorder(of, even, 0, of.rows % 2, 0, of.cols % 2, cv::BORDER_REPLICATE);
    cv::resize(even, out, {even.cols / 2, even.rows / 2}, 0, 0, cv::INTER_AREA);
    return out;
  };
  const cv::Mat half_weight = halved(weight);
  own_ = half_weight(cv::Rect(picture_.tl() / 2, half_));
  if (carries_colour_) {
    const cv::Mat none = cv::Mat::zeros(half_weight.size(), CV_32F);
    cv::merge(std::vector<cv::Mat>{with_margin(halved(plane[1]), 1), with_margin(halved(plane[2]), 1),
                                   with_margin(half_weight, 1), with_margin(none, 1)},
              colour_);
  }

  const auto sampled = [step = step_](cv::Size of) {
    return cv::Size((of.width + step - 1) / step, (of.height + step - 1) / step);
  };
  const cv::Size coarse = sampled(matte.size());
  std::array<cv::Mat, 4> place;
  // Thin smoke is as good as dense one: what counts is how far the edge is.
  const cv::Mat deep = planes.trusted.mul(cv::min(depth / kDeep, 1.0));
  cv::resize(deep, place[0], coarse, 0, 0, cv::INTER_AREA);
  for (std::size_t k = 0; k < plane.size(); ++k) {
    cv::resize(plane[k], place[k + 1], coarse, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(place[k + 1], place[k + 1], {}, options.look_px / step_, options.look_px / step_,
                     cv::BORDER_REPLICATE);
    place[k + 1] *= options.looks;
  }
  cv::merge(place.data(), place.size(), places_.all);
  places_.picture = cv::Rect(picture_.tl() / step_, sampled(size_));
  for (int y = 0; y < size_.height; ++y) {
    const double at = std::clamp((y + 0.5) / step_ - 0.5, 0.0, places_.picture.height - 1.0);
    map_y_.push_back(static_cast<std::int32_t>(at));
    fraction_y_.push_back(static_cast<float>(at - std::floor(at)));
  }
}

CarriedFrame CarriedBase::frame(std::span<const CopyMap> copies) const {
  CarriedFrame out{.luma = cv::Mat::zeros(size_, CV_16S),
                   .blue = cv::Mat::zeros(half_, CV_16S),
                   .red = cv::Mat::zeros(half_, CV_16S),
                   .fraction = cv::Mat::zeros(half_, CV_16S)};
  // Cells read on beyond the maps.
  const auto continued = [](const cv::Mat& map) {
    cv::Mat wider;
    cv::copyMakeBorder(map, wider, 0, 1, 1, kAfter, cv::BORDER_REPLICATE);
    return wider;
  };
  std::vector<Copy> shown;
  for (const CopyMap& copy : copies) {
    std::array<cv::Mat, 2> parts;
    cv::split(copy.source, parts.data());
    shown.push_back({continued(copy.weight), continued(parts[0]), continued(parts[1])});
  }
  Scratch scratch;
  for (const cv::Rect& cell : cells_) carry(cell, shown, out, scratch);
  return out;
}

bool CarriedBase::whole(const cv::Rect& read) const {
  const int left = read.x / kBlock, top = read.y / kBlock, right = (read.br().x - 1) / kBlock + 1,
            bottom = (read.br().y - 1) / kBlock + 1;
  return faded_.at<std::int32_t>(bottom, right) - faded_.at<std::int32_t>(bottom, left) -
             faded_.at<std::int32_t>(top, right) + faded_.at<std::int32_t>(top, left) ==
         0;
}

void CarriedBase::limit_weights(const cv::Rect& cell, const cv::Rect& half, Scratch& s) const {
  for (int row = 0; row < cell.height; ++row) {
    const auto* own = weight_.ptr<float>(picture_.y + cell.y + row + kMargin) + picture_.x + cell.x + kMargin;
    for (int x = 0; x < cell.width; ++x) s.most[row * cell.width + x] = kDeeper * own[x];
  }
  for (int row = 0; row < half.height; ++row) {
    const auto* own = own_.ptr<float>(half.y + row) + half.x;
    for (int x = 0; x < half.width; ++x) s.half_most[row * half.width + x] = kDeeper * own[x];
  }
}

void CarriedBase::carry(const cv::Rect& cell, std::span<const Copy> copies, CarriedFrame& out,
                        Scratch& s) const {
  const cv::Rect half(cell.x / 2, cell.y / 2, (cell.width + 1) / 2, (cell.height + 1) / 2);
  s.sum.fill(0);
  s.mass.fill(0);
  s.colours.fill(0);
  limit_weights(cell, half, s);
  const sampling::Span across = sampling::span_of(picture_.x, size_.width, luma_.cols - 2 * kMargin),
                       down = sampling::span_of(picture_.y, size_.height, luma_.rows - 2 * kMargin);
  const cv::Rect own = cell + picture_.tl();
  const int top = map_y_[cell.y], rows = map_y_[cell.y + cell.height - 1] + 2 - top;
  for (const Copy& copy : copies) {
    // Where each place of the cell comes from, and how far it shows.
    const auto stride = static_cast<std::ptrdiff_t>(copy.u.cols);
    const auto at = [&](const cv::Mat& map) { return map.ptr<float>(top) + cell.x / step_; };
    if (range_of(at(copy.weight), stride, rows, step_).most < kMinShare) continue;
    const Range x = range_of(at(copy.u), stride, rows, step_), y = range_of(at(copy.v), stride, rows, step_);
    const bool within_x = within(x, own.x, cell.width, across),
               within_y = within(y, own.y, cell.height, down);
    const auto widened = [&](const cv::Mat& map, float* to) {
      widen(at(map), stride, map_y_.data() + cell.y, fraction_y_.data() + cell.y, cell, step_, to);
    };
    widened(copy.u, s.u.data());
    widened(copy.v, s.v.data());
    widened(copy.weight, s.share.data());
    for (int row = 0; row < cell.height; ++row) {
      const int to = row * cell.width;
      sources(s.u.data() + to, own.x, 1, across, within_x, s.x.data() + to);
      sources(s.v.data() + to, own.y + row, 0, down, within_y, s.y.data() + to);
    }
    const std::ptrdiff_t plane = luma_.cols, first = kMargin * plane + kMargin;
    read(luma_.ptr<float>(), first, plane, s.x.data(), s.y.data(), cell.area(), s.luma.data());
    if (within_x && within_y && whole(reached(own, x, y)))
      s.weight.fill(1);
    else
      read(weight_.ptr<float>(), first, plane, s.x.data(), s.y.data(), cell.area(), s.weight.data());
    add_copy(s.luma.data(), s.weight.data(), s.most.data(), s.share.data(), cell.area(), s.sum.data(),
             s.mass.data());

    if (!carries_colour_) continue;
    for (int row = 0; row < half.height; ++row) {
      const int upper = 2 * row * cell.width, lower = std::min(2 * row + 1, cell.height - 1) * cell.width;
      half_sources(s.x.data() + upper, s.x.data() + lower, cell.width / 2,
                   s.half_x.data() + row * half.width);
      half_sources(s.y.data() + upper, s.y.data() + lower, cell.width / 2,
                   s.half_y.data() + row * half.width);
      for (int i = 0; i < half.width; ++i) s.half_share[row * half.width + i] = s.share[upper + 2 * i];
      if (cell.width % 2 != 0) {
        const int last = cell.width - 1, to = row * half.width + half.width - 1;
        s.half_x[to] = ((s.x[upper + last] + sampling::kCubicSteps) >> 1) - sampling::kCubicSteps / 2;
        s.half_y[to] = ((((s.y[upper + last] + s.y[lower + last]) >> 1) + sampling::kCubicSteps / 2) >> 1) -
                       sampling::kCubicSteps / 2;
      }
    }
    const auto colour_stride = static_cast<std::ptrdiff_t>(colour_.cols);
    add_colours(colour_.ptr<float>(), kMargin * colour_stride + kMargin, colour_stride, s.half_x.data(),
                s.half_y.data(), s.half_most.data(), s.half_share.data(), half.area(), s.colours.data());
  }
  for (int row = 0; row < cell.height; ++row)
    pack_luma(s.sum.data() + row * cell.width, s.mass.data() + row * cell.width, cell.width,
              out.luma.ptr<std::int16_t>(cell.y + row) + cell.x);
  for (int row = 0; row < half.height; ++row) {
    const int y = half.y + row;
    if (!carries_colour_)
      for (int x = 0; x < half.width; ++x)
        s.colours[4 * (row * half.width + x) + 2] = own_.ptr<float>(y)[half.x + x];
    pack_colours(s.colours.data() + 4 * row * half.width, fraction_, own_.ptr<float>(y) + half.x, half.width,
                 out.blue.ptr<std::int16_t>(y) + half.x, out.red.ptr<std::int16_t>(y) + half.x,
                 out.fraction.ptr<std::int16_t>(y) + half.x);
  }
}

void colour_row(const CarriedFrame& frame, int y, int width, float* blue, float* red, float* fraction) {
  const int rows = frame.fraction.rows, near = y / 2;
  const int far = std::clamp(y % 2 == 0 ? near - 1 : near + 1, 0, rows - 1);
  thread_local std::vector<float> line;
  line.resize(static_cast<std::size_t>(frame.fraction.cols) + 2);
  const auto read = [&](const cv::Mat& plane, float* out) {
    twice(plane.ptr<std::int16_t>(near), plane.ptr<std::int16_t>(far), plane.cols, width, line.data(), out);
  };
  read(frame.fraction, fraction);
  if (blue) read(frame.blue, blue);
  if (red) read(frame.red, red);
}

void show_carried(const CarriedFrame& frame, const cv::Mat& exposure, cv::Mat& out) {
  out.create(frame.luma.size(), CV_32F);
  std::vector<float> fraction(static_cast<std::size_t>(out.cols)),
      none(exposure.empty() ? fraction.size() : 0);
  for (int y = 0; y < out.rows; ++y) {
    colour_row(frame, y, out.cols, nullptr, nullptr, fraction.data());
    lay_over(frame.luma.ptr<std::int16_t>(y), fraction.data(),
             exposure.empty() ? none.data() : exposure.ptr<float>(y), out.cols, out.ptr<float>(y));
  }
}

}  // namespace freshet::synth::animate
