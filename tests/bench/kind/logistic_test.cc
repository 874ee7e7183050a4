#include "bench/kind/logistic.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace freshet::bench {
namespace {

/// Two figures, three classes around their own middles.
Learned three_clouds(int each) {
  Learned rows{Eigen::MatrixXd(3 * each, 2), {}, Eigen::VectorXd::Ones(3 * each)};
  std::mt19937 random(3);
  const auto noise = [&] { return (static_cast<double>(random()) / 4294967296. - .5) * 4; };
  const double middles[3][2] = {{0, 0}, {3, 0}, {0, 3}};
  for (int i = 0; i < 3 * each; ++i) {
    rows.classes.push_back(i % 3);
    rows.figures.row(i) << middles[i % 3][0] + noise(), middles[i % 3][1] + noise();
    rows.weights(i) = 1 + i % 2;
  }
  return rows;
}

/// What learn() minimizes, said plainly.
double loss(const Learned& rows, const Logistic& fit, double ridge) {
  double sum = 0;
  for (Eigen::Index i = 0; i < rows.figures.rows(); ++i)
    sum -= rows.weights(i) *
           std::log(fit.shares(rows.figures.row(i).transpose())(rows.classes[static_cast<std::size_t>(i)]));
  return sum + ridge / 2 * fit.speaks_for.leftCols(2).squaredNorm() +
         1e-3 / 2 * fit.speaks_for.col(2).squaredNorm();
}

TEST(Logistic, NoWeightMovedMakesTheLossSmaller) {
  const Learned rows = three_clouds(30);
  const Logistic fit = learn(rows, {.classes = 3, .ridge = .7, .balance = 0});
  const double least = loss(rows, fit, .7);
  for (Eigen::Index i = 0; i < fit.speaks_for.rows(); ++i)
    for (Eigen::Index k = 0; k < fit.speaks_for.cols(); ++k)
      for (const double step : {-.01, .01}) {
        Logistic moved = fit;
        moved.speaks_for(i, k) += step;
        EXPECT_GT(loss(rows, moved, .7), least) << i << " " << k;
      }
}

TEST(Logistic, TellsTheMiddlesAndKnowsNoMoreFarAway) {
  const Logistic fit = learn(three_clouds(100), {.classes = 3, .balance = .5});
  const double middles[3][2] = {{-.5, -.5}, {3, 0}, {0, 3}};
  for (int k = 0; k < 3; ++k) {
    Eigen::Index best = 0;
    fit.shares(Eigen::Vector2d(middles[k][0], middles[k][1])).maxCoeff(&best);
    EXPECT_EQ(best, k);
  }
  EXPECT_EQ(fit.shares(Eigen::Vector2d(1e3, 0)), fit.shares(Eigen::Vector2d(1e6, 0)));
}

}  // namespace
}  // namespace freshet::bench
