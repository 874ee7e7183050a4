#include "bench/kind/logistic.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace freshet::bench {
namespace {

constexpr double kOffsetRidge = 1e-3;  // offsets are free but for their common part

Eigen::MatrixXd standardized(const Eigen::MatrixXd& figures, const Logistic& fit) {
  Eigen::MatrixXd rows(figures.rows(), figures.cols() + 1);
  for (Eigen::Index i = 0; i < figures.cols(); ++i)
    rows.col(i) = ((figures.col(i).array() - fit.mean(i)) / fit.deviation(i))
                      .max(-fit.farthest)
                      .min(fit.farthest)
                      .matrix();
  rows.col(figures.cols()).setOnes();
  return rows;
}

/// One row a sample.
Eigen::MatrixXd shares_of(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& speaks_for) {
  Eigen::MatrixXd scores = rows * speaks_for.transpose();
  scores.colwise() -= scores.rowwise().maxCoeff().eval();
  scores = scores.array().exp().matrix();
  const Eigen::VectorXd sums = scores.rowwise().sum();
  return sums.cwiseInverse().asDiagonal() * scores;
}

Eigen::VectorXd balanced(const Learned& samples, const LogisticOptions& options) {
  Eigen::VectorXd totals = Eigen::VectorXd::Zero(options.classes);
  for (std::size_t i = 0; i < samples.classes.size(); ++i)
    totals(samples.classes[i]) += samples.weights(static_cast<Eigen::Index>(i));
  const double even = totals.sum() / options.classes;
  Eigen::VectorXd weights = samples.weights;
  for (std::size_t i = 0; i < samples.classes.size(); ++i)
    weights(static_cast<Eigen::Index>(i)) *= std::pow(even / totals(samples.classes[i]), options.balance);
  return weights;
}

}  // namespace

Eigen::VectorXd Logistic::shares(const Eigen::VectorXd& figures) const {
  return shares_of(standardized(figures.transpose(), *this), speaks_for).row(0).transpose();
}

Logistic learn(const Learned& samples, const LogisticOptions& options) {
  const Eigen::Index figures = samples.figures.cols(), columns = figures + 1, classes = options.classes;
  Logistic fit{.mean = {}, .deviation = {}, .speaks_for = {}, .farthest = options.farthest};
  const double total = samples.weights.sum();
  fit.mean = samples.figures.transpose() * samples.weights / total;
  const Eigen::MatrixXd apart = samples.figures.rowwise() - fit.mean.transpose();
  fit.deviation =
      ((apart.array().square().matrix().transpose() * samples.weights) / total).array().sqrt() + 1e-6;

  const Eigen::MatrixXd rows = standardized(samples.figures, fit);
  const Eigen::VectorXd weights = balanced(samples, options);
  Eigen::MatrixXd is = Eigen::MatrixXd::Zero(rows.rows(), classes);
  for (std::size_t i = 0; i < samples.classes.size(); ++i)
    is(static_cast<Eigen::Index>(i), samples.classes[i]) = 1;
  Eigen::RowVectorXd ridge = Eigen::RowVectorXd::Constant(columns, options.ridge);
  ridge(figures) = kOffsetRidge;

  fit.speaks_for = Eigen::MatrixXd::Zero(classes, columns);
  for (int step = 0; step < options.max_steps; ++step) {
    const Eigen::MatrixXd shares = shares_of(rows, fit.speaks_for);
    const Eigen::MatrixXd slope =
        (shares - is).transpose() * weights.asDiagonal() * rows + fit.speaks_for * ridge.asDiagonal();
    Eigen::VectorXd gradient(classes * columns);
    Eigen::MatrixXd curvature(classes * columns, classes * columns);
    for (Eigen::Index a = 0; a < classes; ++a) {
      gradient.segment(a * columns, columns) = slope.row(a).transpose();
      for (Eigen::Index b = 0; b < classes; ++b) {
        const Eigen::VectorXd both =
            (weights.array() * shares.col(a).array() * ((a == b ? 1. : 0.) - shares.col(b).array())).matrix();
        curvature.block(a * columns, b * columns, columns, columns) =
            rows.transpose() * both.asDiagonal() * rows;
      }
      for (Eigen::Index i = 0; i < columns; ++i) curvature(a * columns + i, a * columns + i) += ridge(i);
    }
    const Eigen::VectorXd way = curvature.ldlt().solve(gradient);
    for (Eigen::Index a = 0; a < classes; ++a)
      fit.speaks_for.row(a) -= way.segment(a * columns, columns).transpose();
    if (way.cwiseAbs().maxCoeff() < 1e-9) break;
  }
  return fit;
}

}  // namespace freshet::bench
