// synth/animate/forms/form_look.h — a clip's flames with the brightness and the colours of the picture's.
#pragma once

#include <array>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

/// The level of light that all but a hundredth of these stay below; 0 of none.
float brightest(std::vector<float> levels);

/// Levels of light matched to the picture's, by height above the bed: one map for all frames, so that nothing pumps.
class LevelMaps {
 public:
  /// still    CV_32F, the picture's level in some rectangle. forms  the clip's, moments of it, laid on that rectangle.
  /// top, bed rows of it between which heights are told apart.
  LevelMaps(const cv::Mat& still, std::span<const cv::Mat> forms, double top, double bed);
  /// Monotone at each height; 0 stays 0. level  CV_32F, of that rectangle.
  void apply(cv::Mat& level) const;

 private:
  static constexpr int kSteps = 256;
  static constexpr int kHeights = 4;
  using Map = std::array<float, kSteps + 1>;
  double top_ = 0, bed_ = 1;
  std::array<Map, kHeights> maps_{};
};

/// How much softer a clip's flames have to be, to be as soft as the picture's: sigma, px, 0 where they are. Softness is
/// the share of fine detail (Laplacian, of up to 4 px) in the level's variance.
/// still, forms  as LevelMaps, levels matched.
double softness(const cv::Mat& still, std::span<const cv::Mat> forms);

/// The colour that the picture's flames have at each level of light: dark red, orange, yellow, and white only where
/// they are. CV_32FC3 of light. A level that the picture lacks has the nearest one's colour, as bright as it is itself.
class LightColours {
 public:
  /// light  CV_32FC3, level CV_32F: of the picture (PartedStill).
  LightColours(const cv::Mat& light, const cv::Mat& level);
  const cv::Vec3f& at(float level) const { return colours_[static_cast<int>(level * kSteps + 0.5f)]; }

 private:
  static constexpr int kSteps = 255;
  std::array<cv::Vec3f, kSteps + 2> colours_{};
};

}  // namespace freshet::synth::animate
