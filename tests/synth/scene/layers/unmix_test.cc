#include "synth/scene/layers/unmix.h"

#include <gtest/gtest.h>

#include "platform/random.h"

namespace freshet::synth::scene {
namespace {

constexpr float kNoise = 0.008f * 0.008f;

ColourCluster random_cluster(Random& random) {
  ColourCluster cluster{.mean = {random.next(), random.next(), random.next()}, .covariance = {}, .weight = 1};
  cv::Matx33f root;
  for (float& value : root.val) value = random.between(-0.06f, 0.06f);
  cluster.covariance = root * root.t() + cv::Matx33f::eye() * 0.0004f;
  return cluster;
}

// Eq. 9 of Chuang et al. 2001 as printed: six unknowns.
TwoColours six_by_six(const ColourCluster& f, const ColourCluster& b, const cv::Vec3f& colour, float alpha) {
  const double a = alpha, s = 1 / static_cast<double>(kNoise);
  const cv::Mat fi = cv::Mat(cv::Matx33d(f.covariance)).inv(), bi = cv::Mat(cv::Matx33d(b.covariance)).inv();
  const cv::Mat eye = cv::Mat::eye(3, 3, CV_64F);
  const cv::Vec3d c = colour;
  cv::Mat left(6, 6, CV_64F), right(6, 1, CV_64F), x;
  cv::Mat(fi + eye * (a * a * s)).copyTo(left(cv::Rect(0, 0, 3, 3)));
  cv::Mat(eye * (a * (1 - a) * s)).copyTo(left(cv::Rect(3, 0, 3, 3)));
  cv::Mat(eye * (a * (1 - a) * s)).copyTo(left(cv::Rect(0, 3, 3, 3)));
  cv::Mat(bi + eye * ((1 - a) * (1 - a) * s)).copyTo(left(cv::Rect(3, 3, 3, 3)));
  cv::Mat(fi * cv::Mat(cv::Vec3d(f.mean)) + cv::Mat(c) * (a * s)).copyTo(right.rowRange(0, 3));
  cv::Mat(bi * cv::Mat(cv::Vec3d(b.mean)) + cv::Mat(c) * ((1 - a) * s)).copyTo(right.rowRange(3, 6));
  cv::solve(left, right, x);
  const auto at = [&](int i) { return static_cast<float>(x.at<double>(i)); };
  return {{at(0), at(1), at(2)}, {at(3), at(4), at(5)}};
}

// Eq. 4 to 8: minus twice the log of the posterior.
double cost_of(const ColourCluster& f, const ColourCluster& b, const cv::Vec3f& colour, float alpha,
               const TwoColours& two) {
  const cv::Vec3d r = cv::Vec3d(colour) - cv::Vec3d(two.front) * alpha - cv::Vec3d(two.behind) * (1 - alpha);
  const cv::Vec3d df = cv::Vec3d(two.front) - cv::Vec3d(f.mean),
                  db = cv::Vec3d(two.behind) - cv::Vec3d(b.mean);
  return r.dot(r) / kNoise + df.dot(cv::Matx33d(f.covariance).inv() * df) +
         db.dot(cv::Matx33d(b.covariance).inv() * db);
}

TEST(Unmix, ColoursAtAnAlphaSolveThePapersSystem) {
  Random random(1, 0);
  for (int i = 0; i < 200; ++i) {
    const ColourCluster f = random_cluster(random), b = random_cluster(random);
    const cv::Vec3f colour(random.next(), random.next(), random.next());
    const float alpha = random.next();
    const TwoColours found = colours_at(f, b, colour, kNoise, alpha), truth = six_by_six(f, b, colour, alpha);
    EXPECT_LT(cv::norm(found.front - truth.front, cv::NORM_INF), 2e-3);
    EXPECT_LT(cv::norm(found.behind - truth.behind, cv::NORM_INF), 2e-3);
    const double cost = cost_of(f, b, colour, alpha, truth);
    EXPECT_NEAR(unmix_at(f, b, colour, kNoise, alpha).cost, cost, 1e-2 * cost + 1e-2);
  }
}

TEST(Unmix, IsAtLeastAsLikelyAsGoingToAndFro) {
  Random random(2, 0);
  for (int i = 0; i < 100; ++i) {
    const ColourCluster f = random_cluster(random), b = random_cluster(random);
    const float mixed = random.next();
    const cv::Vec3f colour = f.mean * mixed + b.mean * (1 - mixed);
    float alpha = 0.5f;
    TwoColours two{};
    for (int turn = 0; turn < 50; ++turn) {
      two = six_by_six(f, b, colour, alpha);
      const cv::Vec3f way = two.front - two.behind;  // Eq. 10
      alpha = std::clamp((colour - two.behind).dot(way) / way.dot(way), 0.0f, 1.0f);
    }
    const double to_and_fro = cost_of(f, b, colour, alpha, six_by_six(f, b, colour, alpha));
    EXPECT_LE(unmix(f, b, colour, kNoise).cost, to_and_fro + 0.02 + 0.01 * to_and_fro);
  }
}

TEST(Unmix, FindsTheMixtureOfTwoPlainColours) {
  const cv::Matx33f narrow = cv::Matx33f::eye() * 1e-4f;
  const ColourCluster red{{0.1f, 0.1f, 0.9f}, narrow, 1}, blue{{0.9f, 0.2f, 0.1f}, narrow, 1};
  for (const float alpha : {0.0f, 0.13f, 0.5f, 0.77f, 1.0f})
    EXPECT_NEAR(unmix(red, blue, red.mean * alpha + blue.mean * (1 - alpha), kNoise).alpha, alpha, 0.004f);
}

}  // namespace
}  // namespace freshet::synth::scene
