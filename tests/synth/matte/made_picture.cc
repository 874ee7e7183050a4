#include "tests/synth/matte/made_picture.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <opencv2/imgcodecs.hpp>

#include "tests/harness/scratch_folder.h"

namespace freshet::synth::matte {

MadePicture made_picture(cv::Size size, double softness) {
  MadePicture made{cv::Mat(size, CV_8UC3), cv::Mat(size, CV_8U), Marks(size, CV_8U, cv::Scalar(kBackground))};
  cv::RNG random(7);
  const double radius = 0.3 * size.height;
  const cv::Point2d middle(0.5 * size.width, 0.5 * size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double inside = radius - std::hypot(x - middle.x, y - middle.y);
      const double alpha = std::clamp(inside / softness + 0.5, 0.0, 1.0);
      const int noise = random.uniform(-12, 13);
      const cv::Vec3d fluid(230 + noise, 225 + noise, 215 + noise);
      const cv::Vec3d ground(40 + noise, 90 + 20 * std::sin(x * 0.3) + noise, 30 + noise);
      for (int channel = 0; channel < 3; ++channel)
        made.picture.at<cv::Vec3b>(y, x)[channel] =
            cv::saturate_cast<std::uint8_t>(alpha * fluid[channel] + (1 - alpha) * ground[channel]);
      made.alpha.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(255 * alpha);
    }
  const int rim = 8;
  made.marks(cv::Rect(rim, rim, size.width - 2 * rim, size.height - 2 * rim)).setTo(kUnknown);
  made.marks(cv::Rect(size.width / 2 - 8, size.height / 2 - 4, 16, 8)).setTo(kFluid);
  return made;
}

double sad_fraction(const cv::Mat& alpha, const cv::Mat& truth) {
  return cv::norm(alpha, truth, cv::NORM_L1) / cv::sum(truth)[0];
}

std::filesystem::path written(const ScratchFolder& folder, const std::string& name, const cv::Mat& picture) {
  cv::imwrite(folder / name, picture);
  return folder / name;
}

}  // namespace freshet::synth::matte
