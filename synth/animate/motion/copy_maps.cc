#include "synth/animate/motion/copy_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "platform/random.h"
#include "platform/smoothstep.h"
#include "platform/vectors.h"
#include "synth/sampling/remapped.h"

namespace freshet::synth::animate {
namespace {

constexpr float kReach = 1.5f;            // intervals that a place shows a copy for, at most, either way
constexpr double kHalfOfInterval = 0.75;  // of an interval: after this, half of the places show another copy
constexpr float kLumaApart = 0.15f, kColourApart = 0.09f;  // surroundings that far apart look unlike
// A copy past its time still shows where those whose time it is have nothing to bring: below a brink what the water
// brings from above it would be sky, and what it will be further down is water.
constexpr float kPast = 5e-3f;
// Of all that shows: a copy with less is left out, and the others have that much less, so that nothing goes at once.
constexpr float kFaint = 6e-3f;
// Of their size, beyond CopyOptions::torn: so little drawn out or squeezed, a copy's forms count in full.
constexpr float kTears = 0.35f;
// Of all copies together, before they are brought to a sum of 1: where less goes with a place, the long exposure shows
// with them.
constexpr float kWanted = 0.05f;
constexpr float kUneven = 0.03f;    // what such a copy still counts: more than one past its time
constexpr double kEvenOver_px = 8;  // sigma
constexpr float kLeast = 1e-6f;     // so that some copy shows everywhere
constexpr float kShallow = 1e-3f;
// Of what comes from beyond the picture's sides, from so far on, less than kPast: rather than a mirror a copy shows
// that need not guess, be it past its time.
constexpr float kGuessed = 0.004f, kGuessedFrom_px = 16;
constexpr float kTooShallow = 0.25f, kDeepEnough = 0.75f;  // of the place's own depth
constexpr int kKeptEvery = 16;                             // frames
constexpr std::uint64_t kSeed = 0x636f70696573, kSeedOfStarts = 0x737461727473,
                        kSeedOfAstray = 0x617374726179;
constexpr double kAstrayPatch = 2;  // patches, over which places are astray together
// Of copies that begin displaced.
constexpr int kDrawn = 16;                           // displacements to choose from
constexpr double kLeastAway = 0.5;                   // of the spread
constexpr float kSameWay = 0.95f, kOtherWay = 0.8f;  // cosines: goes with the place, does not
constexpr float kTextureDeep = 0.15f;                // of the depth: from there on no edge comes along
constexpr float kSizeApart = 0.35f;                  // sigma, of the logarithm of sizes
constexpr float kLooksCount = 1 / 9.0f;              // of looks: the place's magnitude is not brought

FRESHET_WIDE void place_row(const float* displacement, float unit, float y, int n, float* to) {
  for (int x = 0; x < n; ++x) {
    to[2 * x] = static_cast<float>(x) + unit * displacement[2 * x];
    to[2 * x + 1] = y + unit * displacement[2 * x + 1];
  }
}

/// Places `displacement` px away from each sample's own, in samples.
cv::Mat places(const cv::Mat& displacement, float sign, int step) {
  cv::Mat out(displacement.size(), CV_32FC2);
  const float unit = sign / static_cast<float>(step);
  for (int y = 0; y < out.rows; ++y)
    place_row(displacement.ptr<float>(y), unit, static_cast<float>(y), out.cols, out.ptr<float>(y));
  return out;
}

FRESHET_WIDE void add_signed(const float* from, float sign, int n, float* sum) {
  for (int i = 0; i < n; ++i) sum[i] = sign * from[i] + sum[i];
}

/// Sources one frame further from a copy's own. middle: HalfwayMotion, of the frame between and this sign. The map
/// before is read where it leads.
cv::Mat step_on(const cv::Mat& sources, const cv::Mat& middle, float sign, int step) {
  cv::Mat out;
  sampling::read_remapped(sources, places(middle, sign, step), out);
  for (int y = 0; y < out.rows; ++y) add_signed(middle.ptr<float>(y), sign, 2 * out.cols, out.ptr<float>(y));
  return out;
}

/// Places of row y of the picture as they are read of it and beyond its sides, and how far they are of the picture.
/// guessed_from: samples.
FRESHET_WIDE void find_row(const float* from, float y, const sampling::Span& across,
                           const sampling::Span& down, float guessed_from, int n, float* within,
                           float* known) {
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) {
    const float own_x = across.first + static_cast<float>(i), own_y = down.first + y;
    const float x = across.first + from[2 * i], y_from = down.first + from[2 * i + 1];
    const float over =
        (std::abs(sampling::beyond(x, own_x, across)) + std::abs(sampling::beyond(y_from, own_y, down))) /
        guessed_from;
    known[i] = 1 + (over < 1 ? over : 1.0f) * (kGuessed - 1);
    within[2 * i] = sampling::carried_from(x, own_x, across);
    within[2 * i + 1] = sampling::carried_from(y_from, own_y, down);
  }
}

/// The divisor of `whole` nearest to `wanted`, on a scale of ratios, and not below half of it. `whole` itself is one.
int nearest_divisor(int whole, int wanted) {
  int best = whole;
  const auto distance = [&](int part) { return std::abs(std::log(static_cast<double>(part) / wanted)); };
  for (int part = (wanted + 1) / 2; part <= whole; ++part)
    if (whole % part == 0 && distance(part) < distance(best)) best = part;
  return best;
}

/// Smooth noise in -1..1 that is level over `patch` samples; evenly spread, so that as many places live early as late.
/// how  cv::INTER_CUBIC: with a slope that does not jump from cell to cell, and seldom up to 1.9.
cv::Mat smooth_noise(cv::Size size, double patch, const Random& random, int how = cv::INTER_LINEAR) {
  // Drawn on a coarse grid that goes beyond the field by one cell.
  const auto cells = [&](int n) { return static_cast<int>(std::ceil(n / patch)) + 3; };
  cv::Mat coarse(cells(size.height), cells(size.width), CV_32F), out;
  for (int y = 0; y < coarse.rows; ++y)
    for (int x = 0; x < coarse.cols; ++x)
      coarse.at<float>(y, x) =
          2 * random.at(static_cast<std::uint64_t>(y) * 65536 + static_cast<std::uint64_t>(x)) - 1;
  const double unit = 1 / patch;
  cv::warpAffine(coarse, out, cv::Matx23d(unit, 0, 1, 0, unit, 1), size, how | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REPLICATE);
  return out;
}

/// How well what a copy brings goes with the place that it is brought to: how deep it comes from, 0..1, and how unlike
/// it looks, in squares of deviations. Fours of depth, luma, blue, red.
FRESHET_WIDE void compare(const float* brought, const float* own, int n, float* deep, float* unlike) {
  for (int x = 0; x < n; ++x) {
    const float luma = (brought[4 * x + 1] - own[4 * x + 1]) / kLumaApart,
                blue = (brought[4 * x + 2] - own[4 * x + 2]) / kColourApart,
                red = (brought[4 * x + 3] - own[4 * x + 3]) / kColourApart;
    // From nearer to an edge than the place itself: the edge would come along.
    const float ratio = (brought[4 * x] + kShallow) / (own[4 * x] + kShallow);
    const float from = (ratio - kTooShallow) / (kDeepEnough - kTooShallow);
    const float low = from < 0.0f ? 0.0f : from, enough = 1.0f < low ? 1.0f : low;
    deep[x] = enough * enough;
    unlike[x] = luma * luma + blue * blue + red * red;
  }
}

/// How far enough a copy of a texture comes from, 0..1. Fours of depth and looks.
FRESHET_WIDE void compare_depths(const float* brought, const float* own, int n, float* deep) {
  for (int x = 0; x < n; ++x) {
    const float wanted = own[4 * x] < kTextureDeep ? own[4 * x] : kTextureDeep;
    const float ratio = (brought[4 * x] + kShallow) / (wanted + kShallow);
    deep[x] = ratio < 1.0f ? ratio : 1.0f;
  }
}

/// How evenly copies are laid out about places, 0..1: what is drawn out is strings and haze, what is squeezed as much
/// crumbs, and what is folded over a mirror. By the singular values of the map from places to their sources. Pairs of a
/// row, those of the rows above and below, n of each, and by what differences across and down are multiplied.
FRESHET_WIDE void find_evenness(const float* left, const float* right, const float* above, const float* below,
                                float per_across, float per_down, float torn, int n, float* out) {
  for (int x = 0; x < n; ++x) {
    const float a = 1 + (right[2 * x] - left[2 * x]) * per_across,
                c = (right[2 * x + 1] - left[2 * x + 1]) * per_across;
    const float b = (below[2 * x] - above[2 * x]) * per_down,
                d = 1 + (below[2 * x + 1] - above[2 * x + 1]) * per_down;
    const float total = a * a + b * b + c * c + d * d, area = a * d - b * c;
    const float spread = total * total - 4 * area * area, over = spread < 0.0f ? 0.0f : spread;
    const float largest = 0.5f * (total + std::sqrt(over));
    const float root = std::sqrt(largest), least = (area < 0.0f ? 0.0f : area) / root, inverse = 1 / root;
    const float even = inverse < least ? inverse : least;
    const float from = (even - torn) * (1 / kTears);
    const float low = from < 0.0f ? 0.0f : from, found = 1.0f < low ? 1.0f : low;
    out[x] = largest > 0 ? found : 0.0f;
  }
}

/// The same for all places of a map.
cv::Mat evenness(const cv::Mat& source, int step, float torn) {
  cv::Mat out(source.size(), CV_32F);
  const float per_px = 1 / static_cast<float>(step);
  const int n = source.cols;
  for (int y = 0; y < out.rows; ++y) {
    const int before = std::max(y - 1, 0), after = std::min(y + 1, source.rows - 1);
    const float *row = source.ptr<float>(y), *above = source.ptr<float>(before),
                *below = source.ptr<float>(after);
    const float per_down = per_px / static_cast<float>(std::max(after - before, 1));
    auto* to = out.ptr<float>(y);
    const auto one = [&](int x) {
      const int left = std::max(x - 1, 0), right = std::min(x + 1, n - 1);
      find_evenness(row + 2 * left, row + 2 * right, above + 2 * x, below + 2 * x,
                    per_px / static_cast<float>(std::max(right - left, 1)), per_down, torn, 1, to + x);
    };
    one(0);
    if (n > 2) find_evenness(row, row + 4, above + 2, below + 2, per_px / 2, per_down, torn, n - 2, to + 1);
    if (n > 1) one(n - 1);
  }
  return out;
}

int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

}  // namespace

/// Mid-point rule: the motion of a frame as it is read halfway along itself. The same for every copy that goes through
/// the frame: the last ones are kept.
class CopyMaps::HalfwayMotion {
 public:
  HalfwayMotion(std::function<cv::Mat(int)> displacement, int step)
      : displacement_(std::move(displacement)), step_(step) {}

  /// sign  -1: of fluid that has come from there, 1: that will be there. Safe from many threads.
  cv::Mat at(int frame, float sign) {
    auto& place = kept_[sign < 0 ? 0 : 1][static_cast<std::size_t>(frame % kKept + kKept) % kKept];
    {
      const std::lock_guard lock(guard_);
      if (!place.second.empty() && place.first == frame) return place.second;
    }
    const cv::Mat velocity = displacement_(frame);
    cv::Mat middle;
    sampling::read_remapped(velocity, places(velocity, sign * 0.5f, step_), middle);
    const std::lock_guard lock(guard_);
    place = {frame, middle};
    return middle;
  }

 private:
  static constexpr int kKept = kKeptEvery + 8;  // frames that one prepare() goes through, as a rule

  std::function<cv::Mat(int)> displacement_;
  int step_;
  std::mutex guard_;
  std::array<std::array<std::pair<int, cv::Mat>, kKept>, 2> kept_;  // frame i at i modulo kKept
};

CopyMaps::~CopyMaps() = default;

int CopyMaps::interval_of(double half_life_s, double fps, int loop_frames) {
  const int interval = std::max(1, static_cast<int>(std::lround(half_life_s * fps / kHalfOfInterval)));
  return loop_frames > 0 ? nearest_divisor(loop_frames, interval) : interval;
}

CopyMaps::CopyMaps(std::function<cv::Mat(int)> displacement, const CopyPlaces& places, int step,
                   const CopyOptions& options, std::optional<CopyStarts> starts,
                   std::optional<OtherWay> other)
    : motion_(std::make_unique<HalfwayMotion>(std::move(displacement), step)),
      everywhere_(places),
      places_(places.own()),
      step_(step),
      options_(options),
      starts_(std::move(starts)),
      reach_(static_cast<int>(std::ceil((kReach + options.stagger) * options.interval))) {
  options_.wander = starts_ ? 0 : std::max(options_.wander, options_.interval);
  if (!other) return;
  other_ = std::make_unique<CopyMaps>(std::move(other->displacement), places, step, options, starts_);
  other_share_ = std::move(other->share);
}

// A copy is alive reach_ frames around its middle.
int CopyMaps::first_copy(int i) const { return -floor_div(reach_ - i, options_.interval); }
int CopyMaps::last_copy(int i) const { return floor_div(i + reach_, options_.interval); }

int CopyMaps::number(int copy) const {
  if (options_.loop_frames == 0) return copy;
  const int copies = options_.loop_frames / options_.interval;
  return copy - floor_div(copy, copies) * copies;
}

/// Before and after in turn, so that at any border every other copy has something to bring. By steps of the golden
/// ratio: neighbours differ, and so do theirs.
int CopyMaps::own_frame(int copy) const {
  const int n = number(copy);
  if (n == 0) return middle(copy);
  const double turn = 0.6180339887 * n, away = 0.1 + 0.4 * (turn - std::floor(turn));
  return middle(copy) + static_cast<int>(std::lround((n % 2 == 0 ? -away : away) * options_.wander));
}

/// How well each place of the picture goes with the one that lies `away` samples before it, 0..1.
cv::Mat CopyMaps::fit(cv::Point away) const {
  cv::Mat out = cv::Mat::zeros(places_.size(), CV_32F);
  const cv::Rect whole({}, places_.size()), from = whole & (whole + away);
  std::vector<float> deep(static_cast<std::size_t>(from.width)), unlike(deep);
  for (int y = from.y; y < from.br().y; ++y) {
    const float *brought = places_.ptr<float>(y) + 4 * from.x,
                *own = places_.ptr<float>(y - away.y) + 4 * (from.x - away.x);
    const auto *goes = starts_->direction.ptr<cv::Vec2f>(y) + from.x,
               *went = starts_->direction.ptr<cv::Vec2f>(y - away.y) + (from.x - away.x);
    const auto* edge = starts_->edges.ptr<float>(y) + from.x;
    compare(brought, own, from.width, deep.data(), unlike.data());
    const cv::Mat& nearness = starts_->nearness;
    const float *near_by = nearness.empty() ? nullptr : nearness.ptr<float>(y) + from.x,
                *near_to = nearness.empty() ? nullptr : nearness.ptr<float>(y - away.y) + (from.x - away.x);
    auto* to = out.ptr<float>(y) + from.x;
    for (int x = 0; x < from.width; ++x) {
      const float same = std::clamp((goes[x].dot(went[x]) - kOtherWay) / (kSameWay - kOtherWay), 0.0f, 1.0f);
      const bool fluid = own[4 * x] > 0 && brought[4 * x] > 0;
      const float larger = near_by ? std::log(near_by[x] / near_to[x]) / kSizeApart : 0.0f;
      to[x] =
          fluid ? same * (1 - edge[x]) * std::exp(-0.5f * (kLooksCount * unlike[x] + larger * larger)) : 0.0f;
    }
  }
  return out;
}

/// Of displacements drawn for a copy, that with which most of the fluid goes: samples.
cv::Point CopyMaps::start(int number, cv::Mat& fits) const {
  const Random random(kSeedOfStarts, static_cast<std::uint64_t>(this->number(number)));
  cv::Point best;
  double most = -1;
  for (std::uint64_t i = 0; i < kDrawn; ++i) {
    // Evenly over a ring's radii and angles; across its own place a copy would agree with the still.
    const double away = starts_->spread * (kLeastAway + (2 - kLeastAway) * random.at(2 * i));
    const double angle = 2 * std::numbers::pi * random.at(2 * i + 1);
    const cv::Point drawn(static_cast<int>(std::lround(away * std::cos(angle))),
                          static_cast<int>(std::lround(away * std::sin(angle))));
    cv::Mat found = fit(drawn);
    const double served = cv::sum(found)[0];
    if (served > most) most = served, best = drawn, fits = found;
  }
  return best;
}

/// By how many px each place of a copy is astray in the copy's own frame.
cv::Mat CopyMaps::astray(int number) const {
  std::array<cv::Mat, 2> parts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Random random(kSeedOfAstray, 2 * static_cast<std::uint64_t>(this->number(number)) + i);
    parts[i] = smooth_noise(places_.size(), kAstrayPatch * options_.patch, random, cv::INTER_CUBIC);
    cv::multiply(parts[i], options_.astray, parts[i]);
  }
  cv::Mat out;
  cv::merge(parts.data(), parts.size(), out);
  return out;
}

/// Sources of a copy's frames in [first, end), as far as it is alive.
void CopyMaps::carry(int number, Copy& copy, int first, int end) const {
  const int own = own_frame(number);
  first = std::max(first, middle(number) - reach_);
  end = std::min(end, middle(number) + reach_ + 1);
  copy.sources.erase(copy.sources.begin(), copy.sources.lower_bound(first));
  if (first >= end) return;
  if (copy.later.empty()) {
    copy.later = smooth_noise(places_.size(), options_.patch,
                              Random(kSeed, static_cast<std::uint64_t>(this->number(number))));
    copy.later *= options_.stagger;
    const cv::Point away = starts_ && this->number(number) != 0 ? start(number, copy.fits) : cv::Point();
    copy.latest = {own, cv::Mat(places_.size(), CV_32FC2, cv::Scalar(step_ * away.x, step_ * away.y))};
    if (this->number(number) != 0 && !options_.astray.empty()) copy.latest.second += astray(number);
    // Kept at fixed distances from its own frame: what is found again is the same to the bit.
    cv::Mat source = copy.latest.second;
    copy.earlier.emplace(own, source);
    for (int frame = own - 1; frame >= first; --frame) {
      source = step_on(source, motion_->at(frame, 1), 1, step_);
      if ((own - frame) % kKeptEvery == 0) copy.earlier.emplace(frame, source);
    }
  }
  if (const int last = std::min(end, own) - 1; first <= last && !copy.sources.contains(last)) {
    // Down from a kept one to what is known; what lies between it and `end` will be asked for next.
    const auto kept = copy.earlier.lower_bound(last);
    int frame = kept->first;
    cv::Mat source = kept->second;
    copy.sources.emplace(frame, source);
    while (frame > first && !copy.sources.contains(frame - 1)) {
      --frame;
      source = step_on(source, motion_->at(frame, 1), 1, step_);
      copy.sources.emplace(frame, source);
    }
    copy.earlier.erase(copy.earlier.begin(), copy.earlier.lower_bound(first));
  }
  auto& [frame, source] = copy.latest;
  for (int asked = std::max(first, own); asked < end; ++asked) {
    for (; frame < asked; ++frame) source = step_on(source, motion_->at(frame, -1), -1, step_);
    copy.sources.emplace(asked, source);
  }
}

void CopyMaps::prepare(int first, int count) {
  const int from = first_copy(first), to = last_copy(first + count - 1);
  std::erase_if(copies_, [&](const auto& entry) { return entry.first < from; });
  std::vector<std::pair<int, Copy*>> alive;
  for (int number = from; number <= to; ++number) alive.emplace_back(number, &copies_[number]);
  oneapi::tbb::parallel_for(std::size_t{0}, alive.size(), [&](std::size_t i) {
    carry(alive[i].first, *alive[i].second, first, first + count);
  });
  if (other_) other_->prepare(first, count);
}

double CopyMaps::still(int i) const {
  const int loop = options_.loop_frames;
  const int away = loop > 0 ? std::min(i % loop, loop - i % loop) : i;
  return smoothstep(0.0, 1.0, 1 - static_cast<double>(away) / options_.interval);
}

/// How well what a copy brings goes with each place, > 0. from: places of its sources, in samples. sound: 0..1, less
/// where it is guessed, drawn out or folded; what is so only waits behind other copies.
cv::Mat CopyMaps::suitability(const Copy& copy, const cv::Mat& source, const cv::Mat& from,
                              cv::Mat& sound) const {
  constexpr float kNothing = 14;  // of unlikeness, halved: exp(-14) is less than kLeast
  cv::Mat even = evenness(source, step_, static_cast<float>(options_.torn)), brought, fits,
          out(places_.size(), CV_32F), within(from.size(), CV_32FC2);
  sound.create(from.size(), CV_32F);
  const cv::Mat& all = everywhere_.all;
  const cv::Rect& own = everywhere_.picture;
  const sampling::Span across = sampling::span_of(own.x, own.width, all.cols),
                       down = sampling::span_of(own.y, own.height, all.rows);
  for (int y = 0; y < from.rows; ++y)
    find_row(from.ptr<float>(y), static_cast<float>(y), across, down,
             kGuessedFrom_px / static_cast<float>(step_), from.cols, within.ptr<float>(y),
             sound.ptr<float>(y));
  sampling::read_remapped(all, within, brought);
  if (!copy.fits.empty()) sampling::read_remapped(copy.fits, within, fits);
  cv::GaussianBlur(even, even, {}, kEvenOver_px / step_, kEvenOver_px / step_, cv::BORDER_REPLICATE);
  cv::multiply(sound, cv::max(even.mul(even), kUneven), sound);
  std::vector<float> deep(out.cols), unlike(out.cols);
  for (int y = 0; y < out.rows; ++y) {
    auto* to = out.ptr<float>(y);
    if (starts_) {
      compare_depths(brought.ptr<float>(y), places_.ptr<float>(y), out.cols, deep.data());
      const auto* fitting = fits.empty() ? nullptr : fits.ptr<float>(y);
      for (int x = 0; x < out.cols; ++x) to[x] = std::max(deep[x] * (fitting ? fitting[x] : 1.0f), kLeast);
      continue;
    }
    compare(brought.ptr<float>(y), places_.ptr<float>(y), out.cols, deep.data(), unlike.data());
    for (int x = 0; x < out.cols; ++x) {
      const float away = 0.5f * unlike[x];
      to[x] = std::max(away < kNothing ? deep[x] * std::exp(-away) : 0.0f, kLeast);
    }
  }
  return out;
}

/// How far the places that a copy brings show by their time, before all copies' weights are brought to a sum of 1.
cv::Mat CopyMaps::timeliness(const Copy& copy, const cv::Mat& from, int age) const {
  // c below is 1/4 there, and its fourth power less than kPast.
  constexpr float kOver = kReach * 2 / 3;
  cv::Mat out;
  sampling::read_remapped(copy.later, from, out);
  const float unit = 1 / static_cast<float>(options_.interval), now = static_cast<float>(age) * unit;
  for (int y = 0; y < out.rows; ++y) {
    auto* to = out.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x) {
      const float intervals = std::abs(now - to[x]);
      if (intervals > kOver) {
        to[x] = kPast;
        continue;
      }
      const float c = 0.5f + 0.5f * std::cos(std::numbers::pi_v<float> / kReach * intervals);
      to[x] = std::max(c * c * c * c, kPast);
    }
  }
  return out;
}

std::vector<CopyMap> CopyMaps::at(int i) const {
  std::vector<CopyMap> out;
  const auto still_here = static_cast<float>(still(i));
  cv::Mat sum = cv::Mat::zeros(places_.size(), CV_32F), suited = sum.clone(), own_suits;
  for (int copy = first_copy(i); copy <= last_copy(i); ++copy) {
    const int age = i - middle(copy);
    const Copy& maps = copies_.at(copy);
    const cv::Mat& source = maps.sources.at(i);
    const cv::Mat from = places(source, 1, step_);
    cv::Mat sound;
    const cv::Mat suits = suitability(maps, source, from, sound),
                  counts = timeliness(maps, from, age).mul(suits);
    if (number(copy) == 0 && std::abs(age) < options_.interval) own_suits = suits.mul(sound);
    out.push_back({counts.mul(sound), source});
    sum += out.back().weight;
    suited += counts;
  }
  // What is guessed or drawn out shows rather than the long exposure; and a texture has none below it.
  const cv::Mat shown =
      starts_ ? cv::Mat(sum.size(), CV_32F, cv::Scalar(1)) : cv::Mat(cv::min(suited / kWanted, 1));
  cv::Mat clear = cv::Mat::zeros(places_.size(), CV_32F);
  for (CopyMap& copy : out) {
    cv::divide(copy.weight, sum, copy.weight);
    copy.weight = cv::max(copy.weight - kFaint, 0);
    clear += copy.weight;
  }
  std::size_t k = 0;
  int own = -1;
  for (int copy = first_copy(i); copy <= last_copy(i); ++copy, ++k) {
    cv::divide(out[k].weight, clear, out[k].weight);
    cv::multiply(out[k].weight, shown, out[k].weight);
    if (number(copy) == 0 && std::abs(i - middle(copy)) < options_.interval) own = static_cast<int>(k);
  }
  if (still_here > 0 && own >= 0) {
    // Around a still frame its own copy takes over, but where what it has to bring lay beside the fluid.
    const cv::Mat taken = still_here * own_suits;
    for (CopyMap& copy : out) cv::multiply(copy.weight, 1 - taken, copy.weight);
    out[own].weight += taken;
  }
  if (other_) {
    for (CopyMap& copy : out) cv::multiply(copy.weight, 1 - other_share_, copy.weight);
    for (CopyMap& copy : other_->at(i)) {
      cv::multiply(copy.weight, other_share_, copy.weight);
      out.push_back(std::move(copy));
    }
  }
  std::erase_if(out, [](const CopyMap& copy) {
    double most = 0;
    cv::minMaxLoc(copy.weight, nullptr, &most);
    return most <= 0;
  });
  return out;
}

}  // namespace freshet::synth::animate
