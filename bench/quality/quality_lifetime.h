// quality_lifetime.h — how long detail lives while it is carried along: a sliding picture keeps it, a fluid
// renews it.
#pragma once

#include <array>
#include <span>

#include <opencv2/core.hpp>

namespace freshet::bench {

inline constexpr int kLifetimeLags = 24;    // frames
inline constexpr int kLifetimeWidth = 400;  // px; wider films are reduced to it: detail has a size

/// Correlation of detail with itself 1 .. kLifetimeLags frames later, where the flow has carried it by then:
/// [lag - 1].
using LifetimeCurve = std::array<double, kLifetimeLags>;

/// Lagrangian autocorrelation. Detail is luma less its blur (sigma 4 px); every sixth frame each pixel begins
/// a way along the flow, frame by frame, and counts at each lag at which it is in the matte and 2 px inside
/// the picture. Sums of products over all ways of a lag, without means: detail has none.
/// luma   CV_8U, all of one size. matte CV_8U of it, counted where above 127.
/// A finer flow keeps more: half-lives compare among films whose flow was computed at one width.
/// flow   one fewer than luma: CV_32FC2, px of luma per frame, of any one size (stretched to the picture's).
/// All NaN when there are fewer than kLifetimeLags + 2 frames. All threads; the same for any number.
/// Cost   three readings of the reduced picture for each lag of each beginning.
LifetimeCurve lifetime_curve(std::span<const cv::Mat> luma, std::span<const cv::Mat> flow,
                             const cv::Mat& matte);

/// Lag from which less than a half is left, s; the greatest lag where half is left to the end.
double half_life_s(const LifetimeCurve& curve, double fps);
/// Mean |difference| over the lags.
double curve_distance(const LifetimeCurve& a, const LifetimeCurve& b);

}  // namespace freshet::bench
