#include "tests/ingest/synthetic_clip.h"

#include <opencv2/imgproc.hpp>

#include "media/video/video_writer.h"

namespace freshet::ingest {
namespace {

/// Smooth noise with detail of some 4 px, CV_32F around 128.
cv::Mat texture(cv::Size size, std::uint64_t seed) {
  cv::RNG rng(seed);
  cv::Mat noise(size, CV_32F);
  rng.fill(noise, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(noise, noise, {}, 1.5);
  noise = (noise - 127.5) * 4 + 128;
  return noise;
}

/// The same with forms of 100 px, which change little while a camera moves by one.
cv::Mat coarse_texture(cv::Size size, std::uint64_t seed) {
  cv::Mat coarse = texture(size / 24, seed + 500), forms;
  cv::resize(coarse, forms, size, 0, 0, cv::INTER_CUBIC);
  return 0.4 * texture(size, seed) + 0.6 * forms;
}

cv::Mat shifted(const cv::Mat& picture, cv::Size size, cv::Vec2d by) {
  const cv::Point2f centre(static_cast<float>(picture.cols / 2.0 - 0.5 - by[0]),
                           static_cast<float>(picture.rows / 2.0 - 0.5 - by[1]));
  cv::Mat part;
  cv::getRectSubPix(picture, size, centre, part);
  return part;
}

}  // namespace

std::vector<cv::Mat> render(const SyntheticClip& clip) {
  const cv::Size large(clip.size.width + 400, clip.size.height + 400);
  cv::Mat scene = clip.coarse ? coarse_texture(large, clip.seed) : texture(large, clip.seed);
  cv::Mat fluid = texture(large, clip.seed + 1000), other = texture(large, clip.seed + 2000);
  cv::RNG rng(clip.seed + 3000);
  std::vector<cv::Mat> frames;
  for (int t = clip.start; t < clip.start + clip.frames; ++t) {
    if (clip.cut_at > 0 && t == clip.cut_at) {
      scene = texture(large, clip.seed + 4000) + 40;
      fluid = texture(large, clip.seed + 5000) + 40;
    }
    const cv::Vec2d camera =
        clip.shift + clip.pan * t + cv::Vec2d(rng.uniform(-1.0, 1.0), rng.uniform(-1.0, 1.0)) * clip.jitter;
    cv::Mat frame = shifted(scene, clip.size, camera);
    if (!clip.moving.empty()) {
      cv::Mat moved = shifted(fluid, clip.size, camera + clip.velocity * t);
      if (clip.changing) {
        const double phase = t / 6.0;
        moved = 128 + (moved - 128) * std::cos(phase) +
                (shifted(other, clip.size, camera - clip.velocity * t) - 128) * std::sin(phase);
      }
      moved(clip.moving).copyTo(frame(clip.moving));
    }
    frame.convertTo(frame, CV_8U);
    if (clip.crossed) {
      const cv::Point2f middle(static_cast<float>(t), static_cast<float>(clip.size.height) / 2);
      cv::ellipse(frame, {middle, {16, 40}, 0}, 250, cv::FILLED, cv::LINE_AA);
      cv::ellipse(frame, {middle - cv::Point2f(0, 6), {10, 16}, 0}, 5, cv::FILLED, cv::LINE_AA);
    }
    frames.push_back(frame);
  }
  return frames;
}

void write_clip(const std::filesystem::path& path, const SyntheticClip& clip) {
  media::VideoWriter writer(path, clip.size, {.fps_num = clip.fps});
  cv::Mat bgr;
  for (const cv::Mat& frame : render(clip)) {
    cv::cvtColor(frame, bgr, cv::COLOR_GRAY2BGR);
    writer.write(bgr);
  }
  writer.finish();
}

}  // namespace freshet::ingest
