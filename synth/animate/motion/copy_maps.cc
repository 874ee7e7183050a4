#include "synth/animate/motion/copy_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::animate {
namespace {

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

/// The divisor of `whole` nearest to `wanted`, on a scale of ratios, and not below half of it: copies that
/// hardly live jitter in their places. `whole` itself is one.
int nearest_divisor(int whole, int wanted) {
  int best = whole;
  const auto distance = [&](int part) { return std::abs(std::log(static_cast<double>(part) / wanted)); };
  for (int part = (wanted + 1) / 2; part <= whole; ++part)
    if (whole % part == 0 && distance(part) < distance(best)) best = part;
  return best;
}

int floor_div(int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); }

}  // namespace

int CopyMaps::third_of(double life_s, double fps, int loop_frames) {
  const int third = std::max(1, static_cast<int>(std::lround(life_s * fps / kCopies)));
  return loop_frames > 0 ? nearest_divisor(loop_frames, third) : third;
}

CopyMaps::CopyMaps(std::function<cv::Mat(int)> displacement, cv::Size size, int step, int third,
                   int loop_frames, bool start_still)
    : displacement_(std::move(displacement)),
      size_(size),
      step_(step),
      third_(third),
      loop_frames_(loop_frames),
      reach_(kCopies * third / 2),
      phase_(loop_frames > 0 && !start_still ? third / 2 : 0),
      start_still_(start_still) {}

/// The first of the three copies that are alive in frame i.
int CopyMaps::first_copy(int i) const {
  // Copy j is alive for 2 |i - j third| <= 3 third.
  const int after = 2 * (i - phase_) - kCopies * third_;  // j >= after / (2 third)
  return -floor_div(-after, 2 * third_);
}

/// In which a copy is as the picture. Steps of the golden ratio: neighbours differ, and so do theirs.
int CopyMaps::own_frame(int copy) const {
  const int number =
      loop_frames_ > 0 ? copy - floor_div(copy, loop_frames_ / third_) * (loop_frames_ / third_) : copy;
  if (number == 0) return middle(copy);
  const double turn = 0.6180339887 * number;
  return middle(copy) + static_cast<int>(std::lround((turn - std::floor(turn) - 0.5) * third_));
}

void CopyMaps::carry_copy(int copy) {
  const int own = own_frame(copy);
  const int first = middle(copy) - reach_, last = middle(copy) + reach_;
  std::vector<cv::Mat>& maps = maps_.at(copy);
  maps.resize(2 * reach_ + 1);
  const cv::Mat itself = cv::Mat::zeros(size_, CV_32FC2);
  cv::Mat map = itself;
  for (int frame = own; frame <= last; ++frame) {
    if (frame > own) map = step_on(map, displacement_(frame - 1), -1, step_);
    maps[frame - first] = map;
  }
  map = itself;
  for (int frame = own - 1; frame >= first; --frame) {
    map = step_on(map, displacement_(frame), 1, step_);
    maps[frame - first] = map;
  }
}

void CopyMaps::prepare(int first, int count) {
  const int from = first_copy(first), to = first_copy(first + count - 1) + kCopies - 1;
  std::erase_if(maps_, [&](const auto& entry) { return entry.first < from; });
  std::vector<int> missing;
  for (int copy = from; copy <= to; ++copy)
    if (maps_.try_emplace(copy).second) missing.push_back(copy);
  oneapi::tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) { carry_copy(missing[i]); });
}

double CopyMaps::beginning(int i) const {
  const int away = loop_frames_ > 0 ? std::min(i % loop_frames_, loop_frames_ - i % loop_frames_) : i;
  const double t = std::clamp(1 - static_cast<double>(away) / third_, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

std::array<CopyMap, CopyMaps::kCopies> CopyMaps::at(int i) const {
  std::array<CopyMap, kCopies> out;
  const int from = first_copy(i);
  const double life = kCopies * third_, still_here = still(i);
  for (int k = 0; k < kCopies; ++k) {
    const int copy = from + k, age = i - middle(copy);
    const double weight = (1 + std::cos(2 * std::numbers::pi * age / life)) / kCopies;
    // Around a still frame its own copy takes over.
    const bool own = loop_frames_ > 0 ? (copy * third_) % loop_frames_ == 0 : copy == 0;
    out[k].weight =
        static_cast<float>((1 - still_here) * weight + (own && std::abs(age) < third_ ? still_here : 0));
    out[k].source = std::abs(age) <= reach_ ? maps_.at(copy)[reach_ + age] : cv::Mat::zeros(size_, CV_32FC2);
  }
  return out;
}

}  // namespace freshet::synth::animate
