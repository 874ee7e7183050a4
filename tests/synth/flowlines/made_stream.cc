#include "tests/synth/flowlines/made_stream.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::synth::flowlines {
namespace {

/// Blobs of about 6 px, as long as all of a clip flows past.
cv::Mat texture(cv::Size size, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat noise(size, CV_32FC3), out;
  random.fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(noise, noise, cv::Size(), 2.0);
  noise = (noise - cv::Scalar::all(127)) * 5 + cv::Scalar::all(127);
  noise.convertTo(out, CV_8U);
  return out;
}

cv::Mat shifted(const cv::Mat& from, double x, double y, cv::Size size) {
  const cv::Matx23d move(1, 0, x, 0, 1, y);
  cv::Mat out;
  cv::warpAffine(from, out, move, size, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REFLECT_101);
  return out;
}

}  // namespace

Footage made_stream(const MadeStream& options) {
  Footage footage{.name = "made", .frames = {}, .fps = 25};
  double way = 0;
  for (int t = 0; t < options.frames; ++t) way += options.speed(t);
  const cv::Mat bank = texture({options.size.width + 200, options.size.height}, 5);
  const cv::Mat water = texture({options.size.width, options.size.height + static_cast<int>(way) + 8}, 9);
  double gone = 0;
  cv::RNG random(77);
  for (int t = 0; t < options.frames; ++t) {
    cv::Mat frame = shifted(bank, 100 - options.camera * t, 0, options.size);
    shifted(water, 0, way - gone, options.size)(options.channel).copyTo(frame(options.channel));
    if (options.flicker > 0) frame += cv::Scalar::all(random.uniform(-options.flicker, options.flicker));
    footage.frames.push_back(frame);
    gone += options.speed(t);
  }
  return footage;
}

}  // namespace freshet::synth::flowlines
