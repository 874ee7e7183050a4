#include "synth/matte/held.h"

#include <cmath>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::matte {
namespace {

constexpr double kMinLeft = 0.01;  // of the matte

}  // namespace

cv::Mat less_held(const cv::Mat& alpha, const cv::Mat& held, const std::string& where) {
  cv::Mat left;
  cv::multiply(alpha, ~held, left, 1 / 255.0);
  const double before = cv::sum(alpha)[0], after = cv::sum(left)[0];
  if (after < kMinLeft * before)
    throw Error(ErrorKind::kInput, where,
                fmt::format("it holds {:.1f} % of the fluid's matte back", 100 * (1 - after / before)),
                "White is what stands: was it drawn the other way round?");
  return left;
}

}  // namespace freshet::synth::matte
