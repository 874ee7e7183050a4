#include "ingest/screening.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "vision/dot.h"

namespace freshet::ingest {
namespace {

constexpr int kThumbnailSide = 64;  // px, longer side, on which frames are compared as wholes

/// 1 - correlation; 0 for two flat pictures, which are alike.
float decorrelation(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat x, y;
  a.convertTo(x, CV_32F);
  b.convertTo(y, CV_32F);
  x -= cv::mean(x);
  y -= cv::mean(y);
  const double floor = 4.0 * static_cast<double>(x.total());  // 2 grey levels: noise does not correlate
  return static_cast<float>(1 - (vision::dot(x, y) + floor) /
                                    (std::sqrt(vision::dot(x, x) * vision::dot(y, y)) + floor));
}

}  // namespace

ChangeMeter::ChangeMeter(cv::Size working) : thumbnail_(within(working, kThumbnailSide)) {}

std::optional<FrameChange> ChangeMeter::add(const cv::Mat& working) {
  cv::resize(working, tiny_, thumbnail_, 0, 0, cv::INTER_AREA);
  histogram_.fill(0);
  const float one = 1.0f / static_cast<float>(tiny_.total());
  for (int y = 0; y < tiny_.rows; ++y) {
    const uchar* row = tiny_.ptr<uchar>(y);
    for (int x = 0; x < tiny_.cols; ++x) histogram_[row[x] * kBins / 256] += one;
  }
  std::optional<FrameChange> change;
  if (!previous_.empty()) {
    change.emplace();
    change->difference = static_cast<float>(cv::norm(tiny_, previous_, cv::NORM_L1) / 255 /
                                            static_cast<double>(tiny_.total()));
    change->decorrelation = decorrelation(tiny_, previous_);
    for (int bin = 0; bin < kBins; ++bin)
      change->histogram += 0.5f * std::abs(histogram_[bin] - previous_histogram_[bin]);
  }
  std::swap(tiny_, previous_);
  previous_histogram_ = histogram_;
  return change;
}

bool is_cut(std::span<const FrameChange> changes, int t) {
  const int n = static_cast<int>(changes.size());
  const FrameChange& here = changes[t];
  // Below these floors no jump is a cut, whatever the neighbours.
  if (here.difference < 0.03f || here.decorrelation < 0.25f) return false;
  FrameChange around;
  for (int s = std::max(0, t - kCutNeighbours); s <= std::min(n - 1, t + kCutNeighbours); ++s) {
    if (s == t) continue;
    around.difference = std::max(around.difference, changes[s].difference);
    around.decorrelation = std::max(around.decorrelation, changes[s].decorrelation);
    around.histogram = std::max(around.histogram, changes[s].histogram);
  }
  return here.difference > 3 * around.difference && here.decorrelation > 3 * around.decorrelation &&
         here.histogram > 1.5f * around.histogram;
}

std::vector<int> find_cuts(std::span<const FrameChange> changes) {
  std::vector<int> cuts;
  for (int t = 0; t < static_cast<int>(changes.size()); ++t)
    if (is_cut(changes, t)) cuts.push_back(t + 1);
  return cuts;
}

double duplicated_fraction(std::span<const FrameChange> changes) {
  if (changes.empty()) return 0;
  // A repeated frame, coded again, differs by a little; a frame of slow clouds may differ by as little, but
  // so do its neighbours.
  int repeated = 0;
  const int n = static_cast<int>(changes.size());
  std::vector<float> around;
  for (int t = 0; t < n; ++t) {
    around.clear();
    for (int s = std::max(0, t - kCutNeighbours); s <= std::min(n - 1, t + kCutNeighbours); ++s) {
      if (s != t) around.push_back(changes[s].difference);
    }
    float usual = 0;
    if (!around.empty()) {
      std::ranges::nth_element(around, around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2));
      usual = around[around.size() / 2];
    }
    if (changes[t].difference == 0 || changes[t].difference < 0.15f * usual) ++repeated;
  }
  return static_cast<double>(repeated) / n;
}

Verdict judge(const Screening& screening, const ScreeningLimits& limits) {
  Verdict verdict;
  if (screening.frames < limits.min_frames) {
    verdict.refusals.push_back(fmt::format("the clip is too short: {} {}, at least {} are wanted",
                                           screening.frames, screening.frames == 1 ? "frame" : "frames",
                                           limits.min_frames));
    verdict.help.push_back("Film for four seconds or more at a time");
  }
  if (!screening.cuts.empty()) {
    verdict.refusals.push_back(fmt::format(
        "the clip is cut: {} at frame {}; a single take is wanted",
        screening.cuts.size() == 1 ? std::string("another take begins")
                                   : fmt::format("{} takes begin, the first", screening.cuts.size()),
        screening.cuts.front()));
    verdict.help.push_back("Ingest it without --force: it is then cut there");
  }
  const FrameTiming& timing = screening.timing;
  if (timing.longest_gap_s > limits.max_gap_s && timing.longest_gap_s * timing.fps > 3)
    verdict.refusals.push_back(fmt::format(
        "frames are missing: none for {:.2f} s after {:.2f} s, {:.2f} s is the limit; cut it there",
        timing.longest_gap_s, timing.gap_after_s, limits.max_gap_s));
  else if (!timing.steady)
    verdict.notes.push_back(fmt::format(
        "its frame rate varies from {:.1f} to {:.1f} frames/s, {:.1f} on average: each frame keeps "
        "its own time, and speeds go by it",
        timing.slowest_fps, timing.fastest_fps, timing.fps));
  const CameraMotion& camera = screening.camera;
  // Half of the windows must show something solid, or a chance agreement among clouds would speak for the
  // camera.
  const bool referenced = camera.windows > 0 && camera.reference_fraction() >= 0.5;
  if (referenced && camera.drift > limits.max_drift) {
    verdict.refusals.push_back(fmt::format(
        "the camera moves: the scene shifts by {:.1f} % of the frame's diagonal, {:.1f} % is the limit",
        100 * camera.drift, 100 * limits.max_drift));
    verdict.help.push_back(kStandStill);
  }
  if (referenced && camera.shake > limits.max_shake) {
    verdict.refusals.push_back(
        fmt::format("the camera shakes: by {:.2f} % of the frame's diagonal (rms), {:.2f} % is the limit",
                    100 * camera.shake, 100 * limits.max_shake));
    if (verdict.help.empty() || verdict.help.back() != kStandStill) verdict.help.push_back(kStandStill);
  }
  if (!referenced && camera.windows > 0) {
    verdict.notes.push_back(fmt::format(
        "no static reference: something solid in {} of {} spans of a second; whether the camera stands "
        "still cannot be told",
        camera.referenced_windows, camera.windows));
  }
  if (screening.duplicated_fraction > limits.max_duplicates) {
    verdict.refusals.push_back(
        fmt::format("{:.0f} % of the frames repeat the one before, {:.0f} % is the limit",
                    100 * screening.duplicated_fraction, 100 * limits.max_duplicates));
    verdict.help.push_back("Give the file that the camera wrote: a converter has repeated frames");
  } else if (screening.duplicated_fraction > 0.02) {
    verdict.notes.push_back(
        fmt::format("{:.0f} % of the frames repeat the one before", 100 * screening.duplicated_fraction));
  }
  if (screening.crossed_fraction > 0)
    verdict.notes.push_back(fmt::format(
        "something crosses it that is not its fluid: no patch is taken from {:.0f} % of the frame",
        std::ceil(100 * screening.crossed_fraction)));
  return verdict;
}

cv::Size within(cv::Size size, int side) {
  const double scale = std::min(1.0, static_cast<double>(side) / std::max(size.width, size.height));
  return {std::max(1, static_cast<int>(std::lround(size.width * scale))),
          std::max(1, static_cast<int>(std::lround(size.height * scale)))};
}

cv::Size screening_size(cv::Size source) { return within(source, CameraTracker::kWorkingSide); }

struct Screener::Impl {
  cv::Size working;
  CameraTracker camera;
  ChangeMeter meter;
  int frames = 0;
  cv::Mat small;
  std::vector<FrameChange> changes;

  Impl(cv::Size source, double fps) : working(screening_size(source)), camera(working, fps), meter(working) {}
};

Screener::Screener(cv::Size source, double fps) : impl_(std::make_unique<Impl>(source, fps)) {}
Screener::~Screener() = default;

void Screener::add(const cv::Mat& luma) {
  Impl& impl = *impl_;
  cv::resize(luma, impl.small, impl.working, 0, 0, cv::INTER_AREA);
  impl.camera.add(impl.small);
  if (const auto change = impl.meter.add(impl.small)) impl.changes.push_back(*change);
  ++impl.frames;
}

Screening Screener::finish() {
  Screening screening;
  screening.frames = impl_->frames;
  screening.camera = impl_->camera.finish();
  screening.cuts = find_cuts(impl_->changes);
  screening.duplicated_fraction = duplicated_fraction(impl_->changes);
  return screening;
}

}  // namespace freshet::ingest
