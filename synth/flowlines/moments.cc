#include "synth/flowlines/moments.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "synth/flowlines/jumps/seam.h"

namespace freshet::synth::flowlines {
namespace {

static_assert(kLeastMargin > kFading);

/// Integral of a tent over [-1, 1] of area 1.
float tents(float x) {
  if (x <= -1) return 0;
  if (x >= 1) return 1;
  return x < 0 ? 0.5f * (1 + x) * (1 + x) : 1 - 0.5f * (1 - x) * (1 - x);
}

/// From 0 to 1 over [-1, 1], evenly but for its ends: no faster anywhere than it must be.
float ramp(float x) {
  constexpr float kEven = 0.6f, kPeak = 1 / (1 + kEven);
  if (x > 0) return 1 - ramp(-x);
  const float from_end = x + 1;
  if (from_end <= 0) return 0;
  constexpr float kEnd = 1 - kEven;
  if (from_end < kEnd) return 0.5f * kPeak * from_end * from_end / kEnd;
  return kPeak * (from_end - 0.5f * kEnd);
}

}  // namespace

Order::Order(const Ladder& ladder, const RepeatOptions& options, int before)
    : first_(ladder.first), repeats_(std::in_place, ladder.cost, options), shift_(-before) {}

Order::Order(const Ladder& ladder, std::vector<Run> period, int frames, int before)
    : first_(ladder.first), shift_(-before), period_(std::move(period)), frames_(frames) {}

void Order::extend() {
  Run run;
  if (repeats_) {
    run = repeats_->next();
  } else {
    run = period_[next_];
    run.start += periods_ * frames_;
    if (++next_ == period_.size()) {
      next_ = 0;
      ++periods_;
    }
  }
  run.start += shift_;
  run.first += first_;
  window_.push_back(run);
}

const std::deque<Run>& Order::covering(std::int64_t from, std::int64_t until) {
  if (window_.empty() && !repeats_) {
    const std::int64_t since = from - shift_;
    periods_ = since / frames_ - (since % frames_ < 0 ? 1 : 0);  // the period in which `from` lies
    next_ = 0;
  }
  while (window_.empty() || window_.back().end() < until) extend();
  while (window_.size() > 1 && window_.front().end() <= from) window_.pop_front();
  return window_;
}

Moments::Moments(const Arrivals& arrivals, cv::Mat fade, std::vector<Order> orders, int clip_frames,
                 const CutOptions& cut)
    : arrivals_(&arrivals),
      fade_(std::move(fade)),
      orders_(std::move(orders)),
      clip_frames_(clip_frames),
      cut_(cut),
      rungs_(orders_.size()) {
  float longest = 0;
  for (const Stream& stream : arrivals.streams) longest = std::max(longest, stream.duration);
  double most = 0;
  cv::minMaxLoc(fade_, nullptr, &most);
  if (cut_.frames != nullptr) most = std::max(cut_.margin, kMostFade);
  reach_ = static_cast<std::int64_t>(std::ceil(static_cast<double>(longest) + most)) + 1;
  if (cut_.frames == nullptr) return;
  fading_.emplace(*cut_.whole, cut_.frames->front().size());
  for (std::size_t k = 0; k < orders_.size(); ++k) {
    const auto number = static_cast<double>(k);
    cv::Mat shown = (arrivals.stream == number) | ((arrivals.neighbour == number) & (arrivals.share > 0));
    cv::resize(shown, shown, cut_.frames->front().size(), 0, 0, cv::INTER_AREA);
    cells_.push_back(cv::boundingRect(shown));
  }
}

void Moments::cut_rung(std::size_t stream, const Jump& jump, Rung& rung) const {
  const cv::Rect cells = cells_[stream];
  if (cells.empty()) return;
  const int reach = cut_.margin - kFading;
  const cv::Size size = cut_.frames->front().size();
  cv::Mat reduced, later(size, CV_32F, cv::Scalar(0)), fade(size, CV_32F, cv::Scalar(1)), shown;
  cv::resize(rung.arrival, reduced, size, 0, 0, cv::INTER_AREA);
  const Meeting meeting =
      meeting_of(*cut_.frames, cells.tl(), reduced(cells), jump.leaves, jump.enters, reach);
  cut(meeting).convertTo(later(cells), CV_32F, 1, -reach);
  fading_->of(cells, reduced(cells) + later(cells), later(cells), jump).copyTo(fade(cells));
  cv::resize(later, shown, fade_.size(), 0, 0, cv::INTER_LINEAR);
  shown += rung.arrival;
  rung.arrival = shown;  // not in place: the stream's own is shared
  rung.fade = cv::Mat();
  cv::resize(fade, rung.fade, fade_.size(), 0, 0, cv::INTER_LINEAR);
}

Moments::Rung Moments::rung_of(std::size_t stream, const Run& before, const Run& run) const {
  const Stream& of = arrivals_->streams[stream];
  Rung rung{.from = before.first - before.start,
            .to = run.first - run.start,
            .start = run.start,
            .arrival = of.arrival,
            .fade = fade_};
  if (!of.arrival_of_entry.empty()) {
    const auto entry =
        static_cast<std::size_t>(std::clamp(run.first, 0, static_cast<int>(of.arrival_of_entry.size()) - 1));
    rung.arrival = cv::Mat();
    cv::resize(of.arrival_of_entry[entry], rung.arrival, fade_.size(), 0, 0, cv::INTER_LINEAR);
  }
  if (cut_.frames != nullptr && before.start != run.start)
    cut_rung(
        stream,
        {.leaves = static_cast<int>(before.first + run.start - before.start),
         .enters = run.first,
         .most = std::max(cut_.margin, std::min(kMostFade, std::min(before.length, run.length) / 2 - 1))},
        rung);
  return rung;
}

/// Rungs of the runs that are near: made when their run comes near, kept until it is over.
void Moments::bring_rungs(std::size_t stream, std::int64_t frame) {
  const std::deque<Run>& runs = orders_[stream].covering(frame - reach_, frame + reach_);
  std::deque<Rung>& rungs = rungs_[stream];
  while (!rungs.empty() && rungs.front().start < runs.front().start) rungs.pop_front();
  for (std::size_t i = rungs.size(); i < runs.size() && runs[i].start <= frame + reach_; ++i)
    rungs.push_back(rung_of(stream, runs[i == 0 ? 0 : i - 1], runs[i]));
}

void Moments::add(std::size_t stream, cv::Point at, std::int64_t frame, float share, Moment& moment) const {
  const std::deque<Rung>& rungs = rungs_[stream];
  const auto frame_of = [&](std::int64_t shift) {
    return static_cast<std::uint16_t>(std::clamp<std::int64_t>(frame + shift, 0, clip_frames_ - 1));
  };
  // The last rung that has come near; what lies before the window's first is that rung's own run.
  std::size_t k = rungs.size() - 1;
  float since = 0, fade = 1;
  for (;; --k) {
    fade = rungs[k].fade.at<float>(at);
    since = static_cast<float>(frame - rungs[k].start) - rungs[k].arrival.at<float>(at);
    if (since > -fade || k == 0) break;
  }
  const float later = k == 0 ? 1.0f : cut_.frames != nullptr ? ramp(since / fade) : tents(since / fade);
  moment.add(frame_of(rungs[k].to), share * later);
  moment.add(frame_of(rungs[k].from), share * (1 - later));
}

void Moments::at(std::int64_t frame, std::vector<Moment>& out) {
  tbb::parallel_for(std::size_t{0}, orders_.size(), [&](std::size_t i) { bring_rungs(i, frame); });
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
