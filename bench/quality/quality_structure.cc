#include "bench/quality/quality_structure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <oneapi/tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "bench/harness/seeded_random.h"
#include "synth/judging/coherence.h"
#include "vision/pyramid.h"

namespace freshet::bench {
namespace {

constexpr std::size_t kPatchesPerFrame = 400, kMinPatches = 9;
constexpr int kPatchPixels = kPatchSide * kPatchSide;

/// Unit vectors, column per projection.
cv::Mat projections() {
  cv::Mat directions(kPatchPixels, kPatchProjections, CV_32F);
  SeededRandom random(5);
  for (int i = 0; i < kPatchPixels * kPatchProjections; ++i)
    directions.ptr<float>()[i] = static_cast<float>(random.normal());
  for (int i = 0; i < kPatchProjections; ++i) directions.col(i) /= cv::norm(directions.col(i));
  return directions;
}

/// Patches of one level of one frame, a row each.
cv::Mat patches_in(const cv::Mat& band, const cv::Mat& matte, std::uint64_t seed) {
  cv::Mat inside;
  cv::resize(matte > 127, inside, band.size(), 0, 0, cv::INTER_AREA);
  constexpr int kHalf = kPatchSide / 2;
  std::vector<cv::Point> middles;
  for (int y = kHalf; y < band.rows - kHalf; ++y)
    for (int x = kHalf; x < band.cols - kHalf; ++x)
      if (inside.at<std::uint8_t>(y, x) > 127) middles.emplace_back(x, y);
  if (middles.size() < kMinPatches) return {};
  const std::size_t wanted = std::min(kPatchesPerFrame, middles.size());
  SeededRandom random(seed);
  cv::Mat patches(static_cast<int>(wanted), kPatchPixels, CV_32F);
  for (std::size_t i = 0; i < wanted; ++i) {
    std::swap(middles[i], middles[i + random.below(middles.size() - i)]);
    const cv::Rect square(middles[i].x - kHalf, middles[i].y - kHalf, kPatchSide, kPatchSide);
    band(square).clone().reshape(1, 1).copyTo(patches.row(static_cast<int>(i)));
  }
  return patches;
}

/// Values sorted, and read at even steps from the least to the greatest.
void quantiles_of(std::vector<float>& values, float* quantiles) {
  std::sort(values.begin(), values.end());
  for (int q = 0; q < kPatchQuantiles; ++q) {
    const double at = static_cast<double>(q) / (kPatchQuantiles - 1) * static_cast<double>(values.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(at), values.size() - 1);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    const auto fraction = static_cast<float>(at - static_cast<double>(below));
    quantiles[q] = values[below] + fraction * (values[above] - values[below]);
  }
}

}  // namespace

PatchSample sample_patches(std::span<const cv::Mat> luma, const cv::Mat& matte) {
  static const cv::Mat directions = projections();
  const std::vector<std::size_t> chosen = synth::judging::spread_frames(luma.size());
  std::vector<PatchSample> by_frame(chosen.size());
  oneapi::tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    std::vector<cv::Mat> bands;
    vision::laplacian_pyramid(luma[chosen[i]], kPatchLevels - 1, bands);
    for (int l = 0; l < kPatchLevels; ++l)
      by_frame[i][l] = patches_in(bands[l], matte, 1000 * (i + 1) + static_cast<std::uint64_t>(l));
  });
  PatchSample sample;
  for (int l = 0; l < kPatchLevels; ++l) {
    std::vector<cv::Mat> parts;
    for (const PatchSample& frame : by_frame)
      if (!frame[l].empty()) parts.push_back(frame[l]);
    if (parts.empty()) continue;
    cv::Mat patches, projected;
    cv::vconcat(parts, patches);
    cv::Mat(patches * directions).copyTo(projected);
    cv::Mat by_projection = projected.t();
    sample[l].create(kPatchProjections, kPatchQuantiles, CV_32F);
    oneapi::tbb::parallel_for(0, kPatchProjections, [&](int p) {
      const float* row = by_projection.ptr<float>(p);
      std::vector<float> values(row, row + by_projection.cols);
      quantiles_of(values, sample[l].ptr<float>(p));
    });
  }
  return sample;
}

std::array<double, kPatchLevels> patch_distances(const PatchSample& a, const PatchSample& b) {
  std::array<double, kPatchLevels> distances{};
  for (int l = 0; l < kPatchLevels; ++l)
    distances[l] = a[l].empty() || b[l].empty()
                       ? std::numeric_limits<double>::quiet_NaN()
                       : cv::norm(a[l], b[l], cv::NORM_L1) / static_cast<double>(a[l].total());
  return distances;
}

}  // namespace freshet::bench
