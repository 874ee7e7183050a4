// synth/scene/layers/unmix.h — one colour as a mixture of two, each from a Gaussian.
#pragma once

#include <array>

#include <opencv2/core.hpp>

#include "synth/scene/layers/colour_clusters.h"

namespace freshet::synth::scene {

constexpr int kAlphaSamples = 13;  // 0, 1/12, ..., 1

struct Unmixed {
  float alpha = 0;
  float cost = 0;  // minus twice the log of the posterior, without its constant: the less, the likelier
  std::array<float, kAlphaSamples> sampled{};  // the same over alpha; of unmix alone
};

/// The likeliest alpha of a pixel, with the likeliest F and B for each alpha.
///
/// colour   = alpha F + (1 - alpha) B + noise; F, B from the clusters, noise of this variance.
/// Cost     .6 us.
/// Source   Chuang et al. 2001, Eq. 4 to 10. For a given alpha their 6 x 6 system is solved by the matrix inversion
///          lemma, a 3 x 3 one: the least cost is r' S^-1 r with r = C - alpha mean F - (1 - alpha) mean B and
///          S = alpha^2 cov F + (1 - alpha)^2 cov B + noise. They go to and fro between that and alpha, which ends
///          at the nearest of several minima, slowly where noise is small; here the cost is sampled over alpha at 13
///          places, and the least of them refined to 1e-3.
Unmixed unmix(const ColourCluster& front, const ColourCluster& behind, const cv::Vec3f& colour, float noise);

/// The same at a given alpha.
Unmixed unmix_at(const ColourCluster& front, const ColourCluster& behind, const cv::Vec3f& colour,
                 float noise, float alpha);

struct TwoColours {
  cv::Vec3f front, behind;  // not clamped
};
/// The likeliest F and B at this alpha.
TwoColours colours_at(const ColourCluster& front, const ColourCluster& behind, const cv::Vec3f& colour,
                      float noise, float alpha);

}  // namespace freshet::synth::scene
