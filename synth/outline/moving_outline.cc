#include "synth/outline/moving_outline.h"

#include <algorithm>
#include <string>
#include <utility>

#include "freshet/error.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::outline {
namespace {

/// CV_32FC3, 255 is white.
cv::Mat in_levels(const cv::Mat& picture) {
  cv::Mat out;
  picture.convertTo(out, CV_32F, picture.depth() == CV_8U ? 1 : 255);
  return out;
}

cv::Mat in_8_bits(const cv::Mat& picture) {
  cv::Mat out = picture;
  if (picture.depth() != CV_8U) picture.convertTo(out, CV_8U, 255);
  return out;
}

cv::Mat seen_of(const cv::Mat& held) {
  cv::Mat seen;
  if (!held.empty()) cv::Mat(~held).convertTo(seen, CV_32F, 1 / 255.0);  // so that 255 leaves 0, to the bit
  return seen;
}

// The fluid's matte as if nothing stood before it: it goes on behind what is held as it is beside it. Else
// the hole would be carried along, and a log would rise with the flames.
cv::Mat behind_held(const cv::Mat& alpha, const cv::Mat& seen) {
  if (seen.empty()) return alpha;
  constexpr double kLeastSeen = 1 / 16.0;  // below, the matte's rounding says more than its values
  cv::Mat whole = cv::min(alpha / cv::max(seen, kLeastSeen), 1.0), trusted = seen.clone();
  trusted.setTo(0, seen < kLeastSeen);
  return sampling::pull_push(whole, trusted);
}

}  // namespace

cv::Mat behind_fluid(const cv::Mat& picture, const cv::Mat& matte, const MovingOutlineOptions& options) {
  if (!options.background.empty() && options.background.size() != picture.size()) {
    const auto size = [](const cv::Mat& of) {
      return std::to_string(of.cols) + " x " + std::to_string(of.rows);
    };
    throw Error(ErrorKind::kInput, "background",
                "it has " + size(options.background) + " px, the picture " + size(picture) +
                    "; the same size expected",
                "Scale or crop it to the picture's size");
  }
  const cv::Mat background = options.background.empty()
                                 ? inpaint_background(in_8_bits(picture), matte, options.inpaint)
                                 : options.background;
  const cv::Mat stills = in_levels(picture), behinds = in_levels(background);
  cv::Mat out(picture.size(), CV_32FC3);
  for (int y = 0; y < picture.rows; ++y) {
    const auto* still = stills.ptr<cv::Vec3f>(y);
    const auto* behind = behinds.ptr<cv::Vec3f>(y);
    const auto* a = matte.ptr<std::uint8_t>(y);
    auto* to = out.ptr<cv::Vec3f>(y);
    for (int x = 0; x < picture.cols; ++x) {
      const float fraction = std::min(1.0f, 8 * static_cast<float>(a[x]) / 255);
      for (int k = 0; k < 3; ++k) to[x][k] = (fraction * behind[x][k] + (1 - fraction) * still[x][k]) / 255;
    }
  }
  return out;
}

MatteSequence::MatteSequence(const cv::Mat& alpha, const cv::Mat& mean_motion, double fps,
                             const DynamicMatteOptions& options, std::function<cv::Mat(int)> motion, int ring,
                             const cv::Mat& held)
    : seen_(seen_of(held)),
      matte_(behind_held(alpha, seen_), mean_motion, fps, options),
      motion_(std::move(motion)) {
  for (int i = 0; i < ring; ++i) matte_.step(motion_(i));
}

cv::Mat MatteSequence::next() {
  // Frame i's motion leads to frame i + 1.
  if (frame_ > 0) matte_.step(motion_(frame_ - 1));
  ++frame_;
  return seen_.empty() ? matte_.matte().clone() : cv::Mat(matte_.matte().mul(seen_));
}

}  // namespace freshet::synth::outline
