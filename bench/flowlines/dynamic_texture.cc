#include "bench/flowlines/dynamic_texture.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace freshet::bench {
namespace {

/// A symmetric matrix's first eigenvectors, and the roots of their eigenvalues, largest first.
struct Roots {
  Eigen::MatrixXd vectors;
  Eigen::VectorXd values;
};
Roots roots_of(const Eigen::MatrixXd& symmetric, Eigen::Index count) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvectors().rightCols(count).rowwise().reverse(),
          solver.eigenvalues().tail(count).reverse().cwiseMax(0).cwiseSqrt()};
}

}  // namespace

DynamicTexture::DynamicTexture(const std::vector<cv::Mat>& clip, const DynamicTextureOptions& options)
    : random_(options.seed), frame_(clip.front().size(), CV_8UC3) {
  const auto frames = static_cast<Eigen::Index>(clip.size()),
             size = static_cast<Eigen::Index>(frame_.total() * 3);
  const Eigen::Index states = std::min<Eigen::Index>(options.states, frames - 2);
  Eigen::MatrixXf films(size, frames);
  for (Eigen::Index t = 0; t < frames; ++t) {
    cv::Mat column(clip.front().size(), CV_32FC3, films.col(t).data());
    clip[static_cast<std::size_t>(t)].convertTo(column, CV_32F);
  }
  mean_ = films.rowwise().mean();
  films.colwise() -= mean_;
  pixels_.resize(size);
  // The singular vectors of many pixels by those of few frames.
  const Roots of_frames = roots_of((films.transpose() * films).cast<double>(), states);
  const Eigen::VectorXd inverse = of_frames.values.cwiseMax(1e-6).cwiseInverse();
  components_ = films * (of_frames.vectors * inverse.asDiagonal()).cast<float>();
  const Eigen::MatrixXd x = of_frames.values.asDiagonal() * of_frames.vectors.transpose();
  const Eigen::MatrixXd before = x.leftCols(frames - 1), after = x.rightCols(frames - 1);
  transition_ = before.transpose().completeOrthogonalDecomposition().solve(after.transpose()).transpose();
  const Eigen::MatrixXd over = after - transition_ * before;
  const Roots left = roots_of(over * over.transpose() / static_cast<double>(frames - 1), states);
  drive_ = left.vectors * left.values.asDiagonal();
  const Eigen::EigenSolver<Eigen::MatrixXd> modes(transition_);
  Eigen::VectorXcd values = modes.eigenvalues();
  found_modulus_ = values.cwiseAbs().maxCoeff();
  if (found_modulus_ > options.max_modulus) {
    for (auto& value : values) value *= std::min(1.0, options.max_modulus / std::max(1e-9, std::abs(value)));
    const Eigen::MatrixXcd vectors = modes.eigenvectors();
    transition_ = (vectors * values.asDiagonal() * vectors.partialPivLu().inverse()).real();
  }
  state_ = x.col(0);
  noise_.resize(states);
}

const cv::Mat& DynamicTexture::next() {
  pixels_.noalias() = components_ * state_.cast<float>();
  pixels_ += mean_;
  cv::Mat(frame_.size(), CV_32FC3, pixels_.data()).convertTo(frame_, CV_8U);
  std::normal_distribution<double> normal;
  for (double& value : noise_) value = normal(random_);
  state_ = transition_ * state_ + drive_ * noise_;
  return frame_;
}

}  // namespace freshet::bench
