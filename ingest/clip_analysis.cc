#include "ingest/clip_analysis.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "vision/patch_features.h"
#include "vision/patch_grid.h"
#include "vision/variant.h"

namespace freshet::ingest {

LumaStatistics::LumaStatistics(cv::Size frame)
    : sum_(cv::Mat::zeros(frame, CV_32S)), squares_(static_cast<std::size_t>(frame.area()), 0) {}

void LumaStatistics::add(const cv::Mat& luma) {
  CV_Assert(luma.type() == CV_8U && luma.size() == sum_.size());
  ++frames_;
  tbb::parallel_for(tbb::blocked_range<int>(0, luma.rows, 64), [&](const tbb::blocked_range<int>& rows) {
    for (int y = rows.begin(); y < rows.end(); ++y) {
      const std::uint8_t* row = luma.ptr<std::uint8_t>(y);
      std::int32_t* sum = sum_.ptr<std::int32_t>(y);
      std::uint64_t* squares = squares_.data() + static_cast<std::size_t>(y) * luma.cols;
      for (int x = 0; x < luma.cols; ++x) {
        sum[x] += row[x];
        squares[x] += static_cast<std::uint32_t>(row[x]) * row[x];
      }
    }
  });
}

cv::Mat LumaStatistics::mean_u16() const {
  cv::Mat mean(sum_.size(), CV_16U);
  const std::uint64_t n = std::max(1u, frames_);
  for (int y = 0; y < mean.rows; ++y) {
    for (int x = 0; x < mean.cols; ++x) {
      const std::uint64_t sum = static_cast<std::uint32_t>(sum_.at<std::int32_t>(y, x));
      mean.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>((sum * 257 + n / 2) / n);
    }
  }
  return mean;
}

cv::Mat LumaStatistics::deviation() const {
  cv::Mat deviation(sum_.size(), CV_32F);
  const double n = std::max(1u, frames_);
  for (int y = 0; y < deviation.rows; ++y) {
    for (int x = 0; x < deviation.cols; ++x) {
      const double mean = sum_.at<std::int32_t>(y, x) / n;
      const double square =
          static_cast<double>(squares_[static_cast<std::size_t>(y) * deviation.cols + x]) / n;
      deviation.at<float>(y, x) = static_cast<float>(std::sqrt(std::max(0.0, square - mean * mean)) / 255);
    }
  }
  return deviation;
}

cv::Mat moving_mask(const cv::Mat& mean_speed_px, const cv::Mat& deviation, double fps,
                    const vision::Settings& settings) {
  cv::Mat speed;
  cv::resize(mean_speed_px, speed, deviation.size(), 0, 0, cv::INTER_LINEAR);
  cv::Mat moving = (speed * (fps / 25) >= settings.min_motion_px) & (deviation >= settings.min_change);
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
  cv::morphologyEx(moving, moving, cv::MORPH_CLOSE, disc);
  cv::morphologyEx(moving, moving, cv::MORPH_OPEN, disc);
  return moving;
}

namespace {

stored::PatchColumns patches_of_variant(const cv::Mat& moving, const cv::Mat& crossed,
                                        const vision::CellMap& motion, std::uint8_t number,
                                        const vision::Variant& variant, const vision::Settings& settings) {
  const int patch = settings.grid.patch;
  const vision::VariantFrame frame = vision::variant_frame(moving.size(), variant);
  const std::vector<cv::Point> positions = vision::patch_positions(frame.size, settings.grid, variant.flip);
  if (positions.empty()) return {};
  cv::Mat valid = vision::valid_mask(moving.size(), variant);
  if (!crossed.empty()) valid.setTo(0, vision::warp_to_variant(crossed, variant) > 0);
  // Half of a moved pixel's weight is where the interpolated edge of the mask lies.
  const cv::Mat moves = (vision::warp_to_variant(moving, variant) > 127) & valid;
  const std::vector<float> inside = vision::patch_coverage(valid, positions, patch);
  const std::vector<float> coverage = vision::patch_coverage(moves, positions, patch);
  const float whole = 1 - 0.5f / static_cast<float>(patch * patch);

  stored::PatchColumns columns;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (inside[i] < whole || coverage[i] < settings.min_coverage) continue;
    columns.variant.push_back(number);
    columns.x.push_back(static_cast<std::uint16_t>(positions[i].x));
    columns.y.push_back(static_cast<std::uint16_t>(positions[i].y));
    const cv::Vec2f mean = vision::patch_mean_motion(motion, frame, positions[i].x, positions[i].y, patch);
    columns.motion.push_back({mean[0], mean[1]});
    columns.coverage.push_back(coverage[i]);
  }
  return columns;
}

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

stored::PatchColumns find_patches(const cv::Mat& moving, const cv::Mat& crossed,
                                  const vision::CellMap& motion, const vision::Settings& settings) {
  const std::vector<vision::Variant> variants = settings.variants();
  std::vector<stored::PatchColumns> parts(variants.size());
  tbb::parallel_for(std::size_t{0}, variants.size(), [&](std::size_t i) {
    parts[i] =
        patches_of_variant(moving, crossed, motion, static_cast<std::uint8_t>(i), variants[i], settings);
  });
  stored::PatchColumns all;
  for (const stored::PatchColumns& part : parts) {
    append(all.variant, part.variant);
    append(all.x, part.x);
    append(all.y, part.y);
    append(all.motion, part.motion);
    append(all.coverage, part.coverage);
  }
  return all;
}

int min_side(const vision::Settings& settings) {
  const float largest = settings.scales.empty() ? 1.0f : std::ranges::max(settings.scales);
  return static_cast<int>(std::ceil(static_cast<float>(settings.grid.patch) / largest));
}

}  // namespace freshet::ingest
