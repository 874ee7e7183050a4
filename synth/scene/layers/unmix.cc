#include "synth/scene/layers/unmix.h"

#include <algorithm>
#include <limits>

namespace freshet::synth::scene {
namespace {

// Inverse of a symmetric, positive definite matrix.
cv::Matx33f inverse(const cv::Matx33f& m) {
  const float a = m(1, 1) * m(2, 2) - m(1, 2) * m(1, 2), b = m(0, 2) * m(1, 2) - m(0, 1) * m(2, 2),
              c = m(0, 1) * m(1, 2) - m(0, 2) * m(1, 1);
  const float per = 1 / (m(0, 0) * a + m(0, 1) * b + m(0, 2) * c);
  const float d = m(0, 0) * m(2, 2) - m(0, 2) * m(0, 2), e = m(0, 1) * m(0, 2) - m(0, 0) * m(1, 2),
              f = m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1);
  return cv::Matx33f(a, b, c, b, d, e, c, e, f) * per;
}

// One pair of Gaussians, and a pixel that they are to explain.
struct Pair {
  const ColourCluster &front, &behind;
  const cv::Vec3f& colour;
  float noise;

  cv::Vec3f rest(float a) const { return colour - front.mean * a - behind.mean * (1 - a); }
  cv::Matx33f information(float a) const {
    cv::Matx33f s = front.covariance * (a * a) + behind.covariance * ((1 - a) * (1 - a));
    for (int c = 0; c < 3; ++c) s(c, c) += noise;
    return inverse(s);
  }
  float cost(float a) const {
    const cv::Vec3f r = rest(a);
    return r.dot(information(a) * r);
  }
};

}  // namespace

Unmixed unmix(const ColourCluster& front, const ColourCluster& behind, const cv::Vec3f& colour, float noise) {
  constexpr float kStep = 1.0f / (kAlphaSamples - 1);
  const Pair pair{front, behind, colour, noise};
  Unmixed best{.alpha = 0, .cost = std::numeric_limits<float>::max()};
  for (std::size_t i = 0; i < kAlphaSamples; ++i) {
    const float a = std::min(1.0f, static_cast<float>(i) * kStep), cost = pair.cost(a);
    best.sampled[i] = cost;
    if (cost < best.cost) best.alpha = a, best.cost = cost;
  }
  for (float step = 0.5f * kStep; step > 1e-3f; step *= 0.5f) {
    const float middle = best.alpha;
    for (const float a : {std::max(0.0f, middle - step), std::min(1.0f, middle + step)})
      if (const float cost = pair.cost(a); cost < best.cost) best.alpha = a, best.cost = cost;
  }
  return best;
}

Unmixed unmix_at(const ColourCluster& front, const ColourCluster& behind, const cv::Vec3f& colour,
                 float noise, float alpha) {
  return {.alpha = alpha, .cost = Pair{front, behind, colour, noise}.cost(alpha)};
}

TwoColours colours_at(const ColourCluster& front, const ColourCluster& behind, const cv::Vec3f& colour,
                      float noise, float alpha) {
  const Pair pair{front, behind, colour, noise};
  const cv::Vec3f share = pair.information(alpha) * pair.rest(alpha);
  return {front.mean + front.covariance * share * alpha,
          behind.mean + behind.covariance * share * (1 - alpha)};
}

}  // namespace freshet::synth::scene
