// dynamic_texture.h — a rival of endless flow lines: a clip's linear dynamical system, driven by noise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace freshet::bench {

struct DynamicTextureOptions {
  int states = 30;             // n: principal components of the clip's frames; at most frames - 2
  double max_modulus = 0.999;  // of eigenvalues: least squares may find a system that grows without an end
  std::uint64_t seed = 1;
};

/// x' = A x + B v, y = mean + C x: C the n first left singular vectors of the frames less their mean, A the least
/// squares of their coordinates on those a frame before, B a root of what A leaves over, v white noise. The first frame
/// has the clip's first coordinates.
/// clip     CV_8UC3, four frames or more of one size.
/// Cost     the clip's size times its frames squared once, its size times n a frame.
/// Source   Doretto, Chiuso, Soatto, Wu 2003, Sec. 3.2; they leave eigenvalues as they are.
class DynamicTexture {
 public:
  explicit DynamicTexture(const std::vector<cv::Mat>& clip, const DynamicTextureOptions& options = {});

  /// CV_8UC3; valid until the next call.
  const cv::Mat& next();
  /// Of mean and C, which is all that a frame needs.
  std::size_t bytes() const {
    return sizeof(float) * static_cast<std::size_t>(mean_.size() + components_.size());
  }
  /// The largest modulus of an eigenvalue of A as least squares found it.
  double found_modulus() const { return found_modulus_; }

 private:
  Eigen::VectorXf mean_, pixels_;
  Eigen::MatrixXf components_;          // C
  Eigen::MatrixXd transition_, drive_;  // A, B
  Eigen::VectorXd state_, noise_;
  double found_modulus_ = 0;
  std::mt19937_64 random_;
  cv::Mat frame_;
};

}  // namespace freshet::bench
