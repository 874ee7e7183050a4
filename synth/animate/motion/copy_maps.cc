#include "synth/animate/motion/copy_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "platform/random.h"

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
constexpr float kTorn = 0.3f,
                kEven = 0.65f;  // of its size: how far a copy's forms may be drawn out or squeezed
// Of all copies together, before they are brought to a sum of 1: where less goes with a place, the long exposure shows
// with them.
constexpr float kWanted = 0.05f;
constexpr float kUneven = 0.03f;  // what such a copy still counts: more than one past its time
constexpr double kEvenOver = 2;   // sigma, samples
constexpr float kLeast = 1e-6f;   // so that some copy shows everywhere
constexpr float kShallow = 1e-3f;
constexpr float kTooShallow = 0.25f, kDeepEnough = 0.75f;  // of the place's own depth
constexpr int kKeptEvery = 16;                             // frames
constexpr std::uint64_t kSeed = 0x636f70696573;

/// Places `displacement` px away from each sample's own, in samples.
cv::Mat places(const cv::Mat& displacement, float sign, int step) {
  cv::Mat out(displacement.size(), CV_32FC2);
  const float unit = sign / static_cast<float>(step);
  for (int y = 0; y < out.rows; ++y) {
    const auto* d = displacement.ptr<cv::Vec2f>(y);
    auto* to = out.ptr<cv::Vec2f>(y);
    for (int x = 0; x < out.cols; ++x)
      to[x] = {static_cast<float>(x) + unit * d[x][0], static_cast<float>(y) + unit * d[x][1]};
  }
  return out;
}

cv::Mat read_at(const cv::Mat& field, const cv::Mat& where) {
  cv::Mat out;
  cv::remap(field, out, where, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return out;
}

/// Sources one frame further from a copy's own. velocity: px a frame, of the frame between; sign -1: fluid that
/// has come from there, 1: that will be there. Mid-point rule, then the map before read where that leads.
cv::Mat step_on(const cv::Mat& sources, const cv::Mat& velocity, float sign, int step) {
  const cv::Mat middle = read_at(velocity, places(velocity, sign * 0.5f, step));
  return sign * middle + read_at(sources, places(middle, sign, step));
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
cv::Mat smooth_noise(cv::Size size, double patch, std::uint64_t stream) {
  // Drawn on a coarse grid that goes beyond the field by one cell.
  const auto cells = [&](int n) { return static_cast<int>(std::ceil(n / patch)) + 3; };
  cv::Mat coarse(cells(size.height), cells(size.width), CV_32F), out;
  const Random random(kSeed, stream);
  for (int y = 0; y < coarse.rows; ++y)
    for (int x = 0; x < coarse.cols; ++x)
      coarse.at<float>(y, x) =
          2 * random.at(static_cast<std::uint64_t>(y) * 65536 + static_cast<std::uint64_t>(x)) - 1;
  const double unit = 1 / patch;
  cv::warpAffine(coarse, out, cv::Matx23d(unit, 0, 1, 0, unit, 1), size,
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return out;
}

/// How well what a copy brings goes with the place that it is brought to, 0..1.
float suits(const cv::Vec4f& brought, const cv::Vec4f& own) {
  const float luma = (brought[1] - own[1]) / kLumaApart, blue = (brought[2] - own[2]) / kColourApart,
              red = (brought[3] - own[3]) / kColourApart;
  // From nearer to an edge than the place itself: the edge would come along.
  const float ratio = (brought[0] + kShallow) / (own[0] + kShallow);
  const float deep = std::clamp((ratio - kTooShallow) / (kDeepEnough - kTooShallow), 0.0f, 1.0f);
  return deep * deep * std::exp(-0.5f * (luma * luma + blue * blue + red * red));
}

/// How evenly a copy is laid out about a place, 0..1: what is drawn out to thrice its length is strings and haze, what
/// is squeezed as much crumbs. By the singular values of the map from places to their sources.
float evenness(const cv::Mat& source, int x, int y, float per_px) {
  const int left = std::max(x - 1, 0), right = std::min(x + 1, source.cols - 1);
  const int above = std::max(y - 1, 0), below = std::min(y + 1, source.rows - 1);
  const auto across = (source.at<cv::Vec2f>(y, right) - source.at<cv::Vec2f>(y, left)) *
                      (per_px / static_cast<float>(std::max(right - left, 1)));
  const auto down = (source.at<cv::Vec2f>(below, x) - source.at<cv::Vec2f>(above, x)) *
                    (per_px / static_cast<float>(std::max(below - above, 1)));
  const float a = 1 + across[0], b = down[0], c = across[1], d = 1 + down[1];
  const float total = a * a + b * b + c * c + d * d, area = a * d - b * c;
  const float largest = 0.5f * (total + std::sqrt(std::max(total * total - 4 * area * area, 0.0f)));
  if (largest <= 0) return 0;
  const float least = std::abs(area) / std::sqrt(largest);
  const float even = std::min(least, 1 / std::sqrt(largest));
  return std::clamp((even - kTorn) / (kEven - kTorn), 0.0f, 1.0f);
}

int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

}  // namespace

int CopyMaps::interval_of(double half_life_s, double fps, int loop_frames) {
  const int interval = std::max(1, static_cast<int>(std::lround(half_life_s * fps / kHalfOfInterval)));
  return loop_frames > 0 ? nearest_divisor(loop_frames, interval) : interval;
}

CopyMaps::CopyMaps(std::function<cv::Mat(int)> displacement, const cv::Mat& places, int step,
                   const CopyOptions& options)
    : displacement_(std::move(displacement)),
      places_(places),
      step_(step),
      options_(options),
      reach_(static_cast<int>(std::ceil((kReach + options.stagger) * options.interval))) {
  options_.wander = std::max(options_.wander, options_.interval);
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

/// Sources of a copy's frames in [first, end), as far as it is alive.
void CopyMaps::carry(int number, Copy& copy, int first, int end) const {
  const int own = own_frame(number);
  first = std::max(first, middle(number) - reach_);
  end = std::min(end, middle(number) + reach_ + 1);
  copy.sources.erase(copy.sources.begin(), copy.sources.lower_bound(first));
  if (first >= end) return;
  if (copy.later.empty()) {
    copy.later =
        smooth_noise(places_.size(), options_.patch, static_cast<std::uint64_t>(this->number(number)));
    copy.later *= options_.stagger;
    copy.latest = {own, cv::Mat::zeros(places_.size(), CV_32FC2)};
    // Kept at fixed distances from its own frame: what is found again is the same to the bit.
    cv::Mat source = copy.latest.second;
    copy.earlier.emplace(own, source);
    for (int frame = own - 1; frame >= first; --frame) {
      source = step_on(source, displacement_(frame), 1, step_);
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
      source = step_on(source, displacement_(frame), 1, step_);
      copy.sources.emplace(frame, source);
    }
    copy.earlier.erase(copy.earlier.begin(), copy.earlier.lower_bound(first));
  }
  auto& [frame, source] = copy.latest;
  for (int asked = std::max(first, own); asked < end; ++asked) {
    for (; frame < asked; ++frame) source = step_on(source, displacement_(frame), -1, step_);
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
}

double CopyMaps::still(int i) const {
  const int loop = options_.loop_frames;
  const int away = loop > 0 ? std::min(i % loop, loop - i % loop) : i;
  const double t = std::clamp(1 - static_cast<double>(away) / options_.interval, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// How well what a copy brings goes with each place, > 0.
cv::Mat CopyMaps::suitability(const cv::Mat& source) const {
  cv::Mat out(places_.size(), CV_32F), even(places_.size(), CV_32F), brought;
  cv::remap(places_, brought, places(source, 1, step_), cv::noArray(), cv::INTER_LINEAR, cv::BORDER_CONSTANT,
            cv::Scalar::all(0));
  const float per_px = 1 / static_cast<float>(step_);
  for (int y = 0; y < out.rows; ++y)
    for (int x = 0; x < out.cols; ++x) even.at<float>(y, x) = evenness(source, x, y, per_px);
  cv::GaussianBlur(even, even, {}, kEvenOver, kEvenOver, cv::BORDER_REPLICATE);
  for (int y = 0; y < out.rows; ++y) {
    auto* to = out.ptr<float>(y);
    const auto *theirs = brought.ptr<cv::Vec4f>(y), *own = places_.ptr<cv::Vec4f>(y);
    const auto* evenly = even.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x)
      to[x] = std::max(suits(theirs[x], own[x]) * std::max(evenly[x] * evenly[x], kUneven), kLeast);
  }
  return out;
}

/// How far the places that a copy brings show, before all copies' weights are brought to a sum of 1.
cv::Mat CopyMaps::weights(const Copy& copy, const cv::Mat& source, int age) const {
  cv::Mat out;
  cv::remap(copy.later, out, places(source, 1, step_), cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  const float unit = 1 / static_cast<float>(options_.interval), now = static_cast<float>(age) * unit;
  for (int y = 0; y < out.rows; ++y) {
    auto* to = out.ptr<float>(y);
    for (int x = 0; x < out.cols; ++x) {
      const float intervals = std::min(std::abs(now - to[x]), kReach);
      const float c = 0.5f + 0.5f * std::cos(std::numbers::pi_v<float> / kReach * intervals);
      to[x] = std::max(c * c * c * c, kPast);
    }
  }
  return out.mul(suitability(source));
}

std::vector<CopyMap> CopyMaps::at(int i) const {
  std::vector<CopyMap> out;
  const auto still_here = static_cast<float>(still(i));
  cv::Mat sum = cv::Mat::zeros(places_.size(), CV_32F);
  for (int copy = first_copy(i); copy <= last_copy(i); ++copy) {
    const int age = i - middle(copy);
    const Copy& maps = copies_.at(copy);
    const cv::Mat& source = maps.sources.at(i);
    out.push_back({weights(maps, source, age), source});
    sum += out.back().weight;
  }
  const cv::Mat shown = cv::min(sum / kWanted, 1);
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
    const cv::Mat taken = still_here * suitability(out[own].source);
    for (CopyMap& copy : out) cv::multiply(copy.weight, 1 - taken, copy.weight);
    out[own].weight += taken;
  }
  std::erase_if(out, [](const CopyMap& copy) {
    double most = 0;
    cv::minMaxLoc(copy.weight, nullptr, &most);
    return most <= 0;
  });
  return out;
}

}  // namespace freshet::synth::animate
