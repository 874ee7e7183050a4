#include "vision/loop_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

constexpr int kSide = 64;              // px of a reduced frame, at most
constexpr std::uint32_t kKept = 1024;  // frames at either end of a clip
constexpr std::uint32_t kMinLoop = 12;
constexpr double kLengthWorth = 0.25;  // of the unrelated distance, for a loop as long as the clip
constexpr int kReach = 2;              // of the filter, frames to either side
constexpr std::array<std::int64_t, 2 * kReach + 1> kBinomial{1, 4, 6, 4, 1};

std::int64_t squared_distance(const std::uint8_t* a, const std::uint8_t* b, std::size_t pixels) {
  std::int32_t sum = 0;  // at most 64 * 64 * 255^2 = 2.7e8
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::int32_t difference = static_cast<std::int32_t>(a[i]) - b[i];
    sum += difference * difference;
  }
  return sum;
}

}  // namespace

LoopFinder::LoopFinder(double fps) : fps_(fps) {}

void LoopFinder::add(const cv::Mat& luma) {
  if (frames_ == 0) {
    const double scale = std::min(1.0, static_cast<double>(kSide) / std::max(luma.cols, luma.rows));
    size_ = {std::max(1, static_cast<int>(std::lround(luma.cols * scale))),
             std::max(1, static_cast<int>(std::lround(luma.rows * scale)))};
    sum_.assign(size_.area(), 0);
    squares_.assign(size_.area(), 0);
  }
  const auto pixels = static_cast<std::size_t>(size_.area());
  cv::Mat reduced;
  cv::resize(luma, reduced, size_, 0, 0, cv::INTER_AREA);
  const auto keep = [&](std::vector<std::uint8_t>& into, std::uint32_t at) {
    if (into.size() < (at + 1) * pixels) into.resize((at + 1) * pixels);
    std::copy_n(reduced.ptr<std::uint8_t>(), pixels, into.begin() + static_cast<std::ptrdiff_t>(at * pixels));
  };
  if (frames_ < kKept) keep(first_, frames_);
  keep(last_, frames_ % kKept);
  const std::uint8_t* values = reduced.ptr<std::uint8_t>();
  for (std::size_t i = 0; i < pixels; ++i) {
    sum_[i] += values[i];
    squares_[i] += static_cast<std::uint64_t>(values[i]) * values[i];
  }
  ++frames_;
}

std::optional<LoopRule> LoopFinder::finish() const {
  if (frames_ < kMinLoopFrames) return std::nullopt;
  const auto pixels = static_cast<std::size_t>(size_.area());
  // What two unrelated frames differ by: twice the variance over time, summed over pixels.
  double unrelated = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double mean = static_cast<double>(sum_[i]) / frames_;
    unrelated += 2 * (static_cast<double>(squares_[i]) / frames_ - mean * mean);
  }
  unrelated = std::max(unrelated, 1e-3);

  const std::uint32_t half = std::clamp(
      static_cast<std::uint32_t>(std::lround(0.25 * std::clamp(fps_, 1.0, 1000.0))),
      static_cast<std::uint32_t>(kReach), std::min((frames_ - 1 - kMinLoop) / 2, (frames_ - 1) / 4));
  const std::uint32_t maximum = frames_ - 1 - 2 * half,
                      minimum = std::min(maximum, std::max({kMinLoop, 2 * half, frames_ / 2}));
  const std::uint32_t last_begin = frames_ > kKept ? frames_ - kKept : 0;  // oldest frame of the ring
  const auto from_first = [&](std::uint32_t t) { return first_.data() + t * pixels; };
  const auto from_last = [&](std::uint32_t t) { return last_.data() + t % kKept * pixels; };

  struct Best {
    double worth = 0, distance = 1;
    std::uint32_t to = 0;
    bool found = false;
  };
  std::vector<Best> best(maximum + 1);  // by length
  oneapi::tbb::parallel_for(minimum, maximum + 1, [&](std::uint32_t length) {
    // Middles whose neighbours are all kept: `to` among the first frames, `from` among the last.
    const std::uint32_t begin = std::max(half, last_begin > length ? last_begin - length + kReach : 0);
    const std::uint32_t end = std::min(frames_ - length - half, kKept - kReach);
    if (begin >= end) return;
    std::vector<std::int64_t> distances(end - begin + 2 * kReach);
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const auto t = static_cast<std::uint32_t>(begin - kReach + i);
      distances[i] = squared_distance(from_first(t), from_last(t + length), pixels);
    }
    for (std::uint32_t to = begin; to < end; ++to) {
      std::int64_t filtered = 0;
      for (std::size_t k = 0; k < kBinomial.size(); ++k) filtered += kBinomial[k] * distances[to - begin + k];
      const double distance = static_cast<double>(filtered) / 16 / unrelated;
      const double worth = kLengthWorth * length / frames_ - distance;
      if (!best[length].found || worth > best[length].worth) best[length] = {worth, distance, to, true};
    }
  });
  LoopRule rule;
  double worth = 0;
  for (std::uint32_t length = minimum; length <= maximum; ++length)
    if (best[length].found && (rule.from == 0 || best[length].worth > worth)) {
      worth = best[length].worth;
      rule = {best[length].to + length, best[length].to, 2 * half, best[length].distance};
    }
  return rule;
}

}  // namespace freshet::vision
