#include "synth/flowlines/clip_motion.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "vision/flow.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kBatch = 16;  // flows that are held at full size together

float percentile(const cv::Mat& values, double share) {
  std::vector<float> sorted(values.begin<float>(), values.end<float>());
  const auto nth =
      sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), nth, sorted.end());
  return *nth;
}

cv::Mat lengths(const cv::Mat& field) {
  cv::Mat parts[2], out;
  cv::split(field, parts);
  cv::magnitude(parts[0], parts[1], out);
  return out;
}

/// Islands below the area, and holes, are closed.
cv::Mat tidy(const cv::Mat& moving, double min_area) {
  const int radius = std::max(2, std::max(moving.cols, moving.rows) / 80);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
  cv::Mat closed, labels, stats, middles, out = cv::Mat::zeros(moving.size(), CV_8U);
  cv::morphologyEx(moving, closed, cv::MORPH_CLOSE, disc);
  cv::morphologyEx(closed, closed, cv::MORPH_OPEN, disc);
  const int islands = cv::connectedComponentsWithStats(closed, labels, stats, middles);
  for (int i = 1; i < islands; ++i)
    if (stats.at<int>(i, cv::CC_STAT_AREA) >= min_area * static_cast<double>(moving.total()))
      out.setTo(255, labels == i);
  return out;
}

float median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The motion of what does not flow: medians over the cells of the reduced flows.
void measure_camera(ClipMotion& motion, const cv::Mat& calm) {
  cv::Mat cells;
  cv::resize(calm, cells, motion.flows.front().size(), 0, 0, cv::INTER_AREA);
  std::vector<float> u, v;
  double sum = 0;
  for (const cv::Mat& flow : motion.flows) {
    u.clear();
    v.clear();
    for (int y = 0; y < cells.rows; ++y)
      for (int x = 0; x < cells.cols; ++x)
        if (cells.at<std::uint8_t>(y, x) == 255) {
          u.push_back(flow.at<cv::Vec2f>(y, x)[0]);
          v.push_back(flow.at<cv::Vec2f>(y, x)[1]);
        }
    if (u.empty()) return;
    const double moved = std::hypot(median_of(u), median_of(v));
    sum += moved;
    motion.camera_max_px = std::max(motion.camera_max_px, moved);
  }
  motion.camera_px = sum / static_cast<double>(motion.flows.size());
}

/// The commonest steady motion: bins of .25 px, three by three together.
void measure_alike(ClipMotion& motion) {
  constexpr float kBin = 0.25f, kSteady = 0.8f;
  std::map<std::pair<int, int>, int> bins;
  for (int y = 0; y < motion.mean.rows; y += 2)
    for (int x = 0; x < motion.mean.cols; x += 2) {
      if (motion.steady.at<float>(y, x) < kSteady) continue;
      const cv::Vec2f v = motion.mean.at<cv::Vec2f>(y, x);
      ++bins[{cvRound(v[0] / kBin), cvRound(v[1] / kBin)}];
    }
  int most = 0;
  for (const auto& [bin, own] : bins) {
    int together = 0;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u)
        if (const auto found = bins.find({bin.first + u, bin.second + v}); found != bins.end())
          together += found->second;
    if (together <= most) continue;
    most = together;
    motion.alike_px = kBin * std::hypot(bin.first, bin.second);
  }
  motion.alike_share = 4.0 * most / static_cast<double>(motion.mean.total());
}

}  // namespace

ClipMotion measure_motion(const std::vector<cv::Mat>& luma, const MotionOptions& options, const Job& job) {
  ClipMotion motion;
  const cv::Size size = luma.front().size();
  const cv::Size cells(std::max(1, size.width / ClipMotion::kFlowStep),
                       std::max(1, size.height / ClipMotion::kFlowStep));
  const int pairs = static_cast<int>(luma.size()) - 1;
  motion.mean = cv::Mat(size, CV_32FC2, cv::Scalar::all(0));
  motion.speed = cv::Mat(size, CV_32F, cv::Scalar::all(0));
  motion.flows.resize(static_cast<std::size_t>(pairs));
  std::vector<cv::Mat> batch(kBatch);
  for (int first = 0; first < pairs; first += kBatch) {
    const int count = std::min(kBatch, pairs - first);
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "flow", "stopped");
    if (job.progress)
      job.progress({"measuring flow", static_cast<std::size_t>(first), static_cast<std::size_t>(pairs)});
    tbb::parallel_for(0, count, [&](int k) {
      const auto i = static_cast<std::size_t>(first + k);
      batch[static_cast<std::size_t>(k)] = vision::optical_flow(luma[i], luma[i + 1]);
      cv::resize(batch[static_cast<std::size_t>(k)], motion.flows[i], cells, 0, 0, cv::INTER_AREA);
    });
    // Sums in the order of the frames: the same for any number of threads.
    for (int k = 0; k < count; ++k) {
      motion.mean += batch[static_cast<std::size_t>(k)];
      motion.speed += lengths(batch[static_cast<std::size_t>(k)]);
    }
  }
  motion.mean *= 1.0 / pairs;
  motion.speed *= 1.0 / pairs;
  const cv::Mat length = lengths(motion.mean);
  motion.steady = length / (motion.speed + 1e-3);
  const double threshold =
      std::max(options.min_speed, options.min_share * static_cast<double>(percentile(length, 0.95)));
  motion.matte = tidy((length > threshold) & (motion.steady > options.min_steady), options.min_area);
  const cv::Mat calm = (motion.speed < 0.5 * percentile(motion.speed, 0.95)) & (motion.matte == 0);
  motion.still_share = cv::countNonZero(calm) / static_cast<double>(calm.total());
  measure_camera(motion, calm);
  measure_alike(motion);
  return motion;
}

}  // namespace freshet::synth::flowlines
