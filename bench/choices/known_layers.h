// bench/choices/known_layers.h — pictures whose layers are known: what was laid over what, and how softly.
#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

namespace freshet::bench {

struct KnownLayers {
  std::string name;
  cv::Mat picture;        // CV_32FC3, 0..1, rounded to 8 bits: the front over what is behind
  cv::Mat alpha;          // CV_32F
  cv::Mat front, behind;  // CV_32FC3
  cv::Mat trimap;         // CV_8U: 0, 128, 255, the unsure some px wider than what is soft
};

/// Alpha of a drawn tree with bare twigs and clumps of leaves, its root in the middle below: CV_32F, soft by
/// supersampling. Some 15 % of the picture.
cv::Mat drawn_tree(cv::Size size, std::uint64_t seed);

/// An outline as a boat's or a bush's: a closed curve with waves, CV_32F, soft by a pixel. `reach`, of the height.
cv::Mat drawn_outline(cv::Size size, cv::Point2d middle, double reach, std::uint64_t seed);

/// Puffs of a simulated smoke (an alpha that is soft everywhere), CV_32F.
cv::Mat simulated_smoke(cv::Size size, std::uint64_t seed);

/// One over the other. front, behind   CV_32FC3 of alpha's size.
/// unsure_px   how much wider than what is soft the trimap's unsure part is, to either side.
KnownLayers laid_over(const std::string& name, const cv::Mat& front, const cv::Mat& alpha,
                      const cv::Mat& behind, int unsure_px);

}  // namespace freshet::bench
