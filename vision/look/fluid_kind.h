// vision/look/fluid_kind.h — which class of fluid a still shows: water, fire, smoke or clouds, told from its look alone.
#pragma once

#include <array>
#include <string_view>

#include <opencv2/core.hpp>

namespace freshet::vision {

inline constexpr std::array<const char*, 4> kFluidKinds{"water", "fire", "smoke", "clouds"};
inline constexpr int kLookReadings = 25;

/// What the look is judged by, in the order of fluid_look; colours and luma in 0..1.
const char* look_name(std::size_t reading);

/// How the fluid looks, on the picture reduced to a longer side of 256 px: luma, colour, how colour goes with
/// luma, contrast by size of detail, the direction of its edges, and where in the picture it lies.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size, 255 where the fluid is, and somewhere so.
std::array<float, kLookReadings> fluid_look(const cv::Mat& picture, const cv::Mat& matte);

struct FluidKind {
  std::array<double, kFluidKinds.size()> share{};  // likelihoods, of sum 1
  int best = 0;
  std::string_view name() const { return kFluidKinds[static_cast<std::size_t>(best)]; }
  double sureness() const { return share[static_cast<std::size_t>(best)]; }
  /// Of 52 clips, each with its scene left out, 26 are sure, and 23 of these right; of all, 41 are right.
  bool sure() const { return sureness() >= .8; }
};

/// A linear discriminant with a common, shrunk covariance (Friedman 1989), learned from three frames each of 44 clips; the
/// likelihoods are flattened, since so few clips make it too certain of itself.
FluidKind fluid_kind(const std::array<float, kLookReadings>& look);

}  // namespace freshet::vision
