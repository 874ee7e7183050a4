#include "synth/animate/clips/detail_life.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "media/frame/frame.h"
#include "query/stored/clip_frames.h"
#include "vision/flow.h"

namespace freshet::synth::animate {
namespace {

constexpr int kWidth = 320;          // px: detail and flow are followed on frames of this width
constexpr std::uint32_t kLags = 24;  // frames
constexpr std::uint32_t kFrames = kLags + 9;
constexpr std::uint32_t kSeedStep = 4;  // frames between those that are followed
constexpr double kSigma = 4;            // px: detail is what a blur of this takes away
constexpr float kMoving = 0.2f;         // px a frame
constexpr double kLongest = 6;          // s

cv::Mat detail_of(const cv::Mat& luma, cv::Size size) {
  cv::Mat small, blurred;
  cv::resize(luma, small, size, 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(small, blurred, {}, kSigma, kSigma, cv::BORDER_REFLECT_101);
  return small - blurred;
}

/// Sums over the places that are followed, for the correlation at one lag.
struct Sums {
  double product = 0, first = 0, second = 0;
  double correlation() const { return product / std::sqrt(std::max(first * second, 1e-12)); }
};

}  // namespace

double detail_half_life_s(const store::Snapshot& snapshot, store::ClipId clip) {
  const store::ClipRecord& record = snapshot.clip(clip);
  const std::uint32_t frames = std::min(record.frame_count, kFrames);
  if (frames < 3 || record.flow.planes.size() != 2 || record.flow.frames + 1 != record.frame_count) return 1;
  const cv::Size size(kWidth, std::max(16, static_cast<int>(std::lround(static_cast<double>(kWidth) *
                                                                        record.height / record.width))));
  std::vector<cv::Mat> detail;
  {
    const query::ClipFrames stored(snapshot, clip);
    for (const media::Frame& frame : stored.read(0, frames)) {
      cv::Mat luma;
      media::to_luma(frame).convertTo(luma, CV_32F, 1.0 / 255);
      detail.push_back(detail_of(luma, size));
    }
  }
  // Flow from frame to frame, px of the small frames.
  const store::PlaneShape plane = record.flow.planes[0];
  const cv::Size coarse(static_cast<int>(plane.width), static_cast<int>(plane.height));
  std::array<std::vector<std::int16_t>, 2> samples;
  for (std::uint32_t p = 0; p < 2; ++p) {
    samples[p].resize(static_cast<std::size_t>(coarse.area()) * (frames - 1));
    snapshot.read(clip, store::Stream::kFlow, p, {0, 0, plane.width, plane.height}, 0, frames - 1,
                  std::as_writable_bytes(std::span(samples[p])));
  }
  std::vector<cv::Mat> flow;
  for (std::uint32_t i = 0; i + 1 < frames; ++i) {
    std::array<cv::Mat, 2> parts;
    for (std::size_t p = 0; p < 2; ++p) {
      const cv::Mat whole(coarse, CV_16S, samples[p].data() + static_cast<std::size_t>(coarse.area()) * i);
      whole.convertTo(parts[p], CV_32F, vision::kFlowUnit * kWidth / record.width);
      cv::resize(parts[p], parts[p], size, 0, 0, cv::INTER_AREA);
    }
    cv::merge(parts.data(), 2, flow.emplace_back());
  }

  std::vector<Sums> sums(frames - 1);
  for (std::uint32_t seed = 0; seed + 2 < frames; seed += kSeedStep) {
    if (seed > 0 && seed + kLags >= frames + kSeedStep) break;
    cv::Mat at(size, CV_32FC2), step, now;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        at.at<cv::Vec2f>(y, x) = {static_cast<float>(x), static_cast<float>(y)};
    for (std::uint32_t lag = 1; seed + lag < frames; ++lag) {
      cv::remap(flow[seed + lag - 1], step, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      at += step;
      cv::remap(detail[seed + lag], now, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      Sums& sum = sums[lag - 1];
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
          const cv::Vec2f v = flow[seed].at<cv::Vec2f>(y, x), p = at.at<cv::Vec2f>(y, x);
          if (std::hypot(v[0], v[1]) < kMoving || p[0] < 1 || p[1] < 1 ||
              p[0] > static_cast<float>(size.width - 2) || p[1] > static_cast<float>(size.height - 2))
            continue;
          const double a = detail[seed].at<float>(y, x), b = now.at<float>(y, x);
          sum.product += a * b;
          sum.first += a * a;
          sum.second += b * b;
        }
    }
  }
  if (sums.front().first <= 0) return 1;
  const double frame_s = static_cast<double>(record.fps_den) / static_cast<double>(record.fps_num);
  double last = 1;
  for (std::size_t i = 0; i < sums.size() && sums[i].first > 0; ++i) {
    const double here = sums[i].correlation();
    // Between two lags, straight.
    if (here < 0.5) return frame_s * (static_cast<double>(i) + (last - 0.5) / (last - here));
    last = here;
  }
  const double fall = -std::log(std::clamp(last, 0.5, 0.9999)) / static_cast<double>(sums.size());
  return std::min(kLongest, frame_s * std::log(2.0) / fall);
}

}  // namespace freshet::synth::animate
