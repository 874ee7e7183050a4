#include "synth/flowlines/moments.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

/// Integral of a tent over [-1, 1] of area 1.
float tents(float x) {
  if (x <= -1) return 0;
  if (x >= 1) return 1;
  return x < 0 ? 0.5f * (1 + x) * (1 + x) : 1 - 0.5f * (1 - x) * (1 - x);
}

}  // namespace

Order::Order(const Ladder& ladder, const RepeatOptions& options, int before)
    : first_(ladder.first), repeats_(std::in_place, ladder.cost, options), shift_(-before) {}

Order::Order(const Ladder& ladder, std::vector<Run> period, int frames)
    : first_(ladder.first), period_(std::move(period)), frames_(frames) {}

void Order::extend() {
  Run run;
  if (repeats_) {
    run = repeats_->next();
    run.start += shift_;
  } else {
    run = period_[next_];
    run.start += periods_ * frames_;
    if (++next_ == period_.size()) {
      next_ = 0;
      ++periods_;
    }
  }
  run.first += first_;
  window_.push_back(run);
}

const std::deque<Run>& Order::covering(std::int64_t from, std::int64_t until) {
  if (window_.empty() && !repeats_) {
    periods_ = from / frames_ - (from % frames_ < 0 ? 1 : 0);  // the period in which `from` lies
    next_ = 0;
  }
  while (window_.empty() || window_.back().end() < until) extend();
  while (window_.size() > 1 && window_.front().end() <= from) window_.pop_front();
  return window_;
}

Moments::Moments(const Arrivals& arrivals, cv::Mat fade, std::vector<Order> orders, int clip_frames)
    : arrivals_(&arrivals),
      fade_(std::move(fade)),
      orders_(std::move(orders)),
      clip_frames_(clip_frames),
      rungs_(orders_.size()) {
  float longest = 0;
  for (const Stream& stream : arrivals.streams) longest = std::max(longest, stream.duration);
  double most = 0;
  cv::minMaxLoc(fade_, nullptr, &most);
  reach_ = static_cast<std::int64_t>(std::ceil(static_cast<double>(longest) + most)) + 1;
}

void Moments::rungs_of(std::size_t stream, std::int64_t frame) {
  const Stream& of = arrivals_->streams[stream];
  const std::deque<Run>& runs = orders_[stream].covering(frame - reach_, frame + reach_);
  std::vector<Rung>& rungs = rungs_[stream];
  rungs.clear();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].start > frame + reach_) break;
    const Run& before = runs[i == 0 ? 0 : i - 1];
    Rung rung{.from = before.first - before.start,
              .to = runs[i].first - runs[i].start,
              .start = runs[i].start,
              .arrival = of.arrival};
    if (!of.arrival_of_entry.empty()) {
      const auto entry = static_cast<std::size_t>(
          std::clamp(runs[i].first, 0, static_cast<int>(of.arrival_of_entry.size()) - 1));
      cv::resize(of.arrival_of_entry[entry], rung.arrival, fade_.size(), 0, 0, cv::INTER_LINEAR);
    }
    rungs.push_back(std::move(rung));
  }
}

void Moments::add(std::size_t stream, cv::Point at, std::int64_t frame, float share, Moment& moment) const {
  const std::vector<Rung>& rungs = rungs_[stream];
  const float fade = fade_.at<float>(at);
  const auto frame_of = [&](std::int64_t shift) {
    return static_cast<std::uint16_t>(std::clamp<std::int64_t>(frame + shift, 0, clip_frames_ - 1));
  };
  // The last rung that has come near; what lies before the window's first is that rung's own run.
  std::size_t k = rungs.size() - 1;
  float since = 0;
  for (;; --k) {
    since = static_cast<float>(frame - rungs[k].start) - rungs[k].arrival.at<float>(at);
    if (since > -fade || k == 0) break;
  }
  const float later = k == 0 ? 1.0f : tents(since / fade);
  moment.add(frame_of(rungs[k].to), share * later);
  moment.add(frame_of(rungs[k].from), share * (1 - later));
}

void Moments::at(std::int64_t frame, std::vector<Moment>& out) {
  for (std::size_t i = 0; i < orders_.size(); ++i) rungs_of(i, frame);
  out.resize(fade_.total());
  tbb::parallel_for(0, fade_.rows, [&](int y) {
    for (int x = 0; x < fade_.cols; ++x) {
      const cv::Point at(x, y);
      Moment& moment = out[static_cast<std::size_t>(y) * static_cast<std::size_t>(fade_.cols) +
                           static_cast<std::size_t>(x)];
      moment = Moment{};
      const float share = arrivals_->share.at<float>(at);
      add(arrivals_->stream.at<std::uint8_t>(at), at, frame, 1 - share, moment);
      if (share > 0) add(arrivals_->neighbour.at<std::uint8_t>(at), at, frame, share, moment);
    }
  });
}

}  // namespace freshet::synth::flowlines
