// bench/kind/logistic.h — multinomial logistic regression with a ridge, by Newton's method.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace freshet::bench {

/// One row a sample: its figures, its class (0 .. classes - 1) and how much it counts.
struct Learned {
  Eigen::MatrixXd figures;
  std::vector<int> classes;
  Eigen::VectorXd weights;
};

struct LogisticOptions {
  int classes = 4;
  double ridge = .5;    // of the squared weights of standardized figures, not of the offsets
  double balance = .5;  // 0: classes count by their samples; 1: each class alike
  double farthest = 3;  // deviations; what lies further counts as if it were there
  int max_steps = 30;
};

struct Logistic {
  Eigen::VectorXd mean, deviation;  // of the figures
  Eigen::MatrixXd speaks_for;       // classes x (figures + 1), by deviation; the offset last
  double farthest = 3;

  /// Of sum 1, by class.
  Eigen::VectorXd shares(const Eigen::VectorXd& figures) const;
};

/// The minimum of the weighted negative log likelihood plus ridge / 2 times the squared weights.
/// Needs no sample of every class. Cost O(steps classes^2 samples figures^2). Deterministic.
Logistic learn(const Learned& samples, const LogisticOptions& options = {});

}  // namespace freshet::bench
