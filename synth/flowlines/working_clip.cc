#include "synth/flowlines/working_clip.h"

#include <algorithm>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kWorkingSide = 480;  // px
constexpr int kMinFrames = 16;
constexpr double kCameraPx = 0.35;  // px a frame of what stands still
constexpr double kMaxAlike = 0.25;  // of the picture
constexpr double kMinStill = 0.02;  // of the picture, for the camera to be judged by

}  // namespace

WorkingClip working_clip(const Footage& footage, const Job& job) {
  if (footage.count() < kMinFrames)
    throw Error(ErrorKind::kInput, footage.name,
                fmt::format("it has {} frames, at least {} are needed", footage.count(), kMinFrames),
                "Give a longer clip: two seconds are good");
  WorkingClip clip;
  const cv::Size full = footage.size();
  clip.scale = std::min(1.0, static_cast<double>(kWorkingSide) / std::max(full.width, full.height));
  const cv::Size size(std::max(16, cvRound(full.width * clip.scale)),
                      std::max(16, cvRound(full.height * clip.scale)));
  clip.frames.resize(footage.frames.size());
  clip.luma.resize(footage.frames.size());
  tbb::parallel_for(std::size_t{0}, clip.frames.size(), [&](std::size_t i) {
    if (size == full)
      clip.frames[i] = footage.frames[i];
    else
      cv::resize(footage.frames[i], clip.frames[i], size, 0, 0, cv::INTER_AREA);
    // Local contrast is evened out: flow sees little of a fall at dusk, and half of what it sees too slow.
    cv::cvtColor(clip.frames[i], clip.luma[i], cv::COLOR_BGR2GRAY);
    cv::createCLAHE(3.0, cv::Size(8, 8))->apply(clip.luma[i], clip.luma[i]);
  });
  clip.motion = measure_motion(clip.luma, {}, job);
  return clip;
}

void judge_camera(const WorkingClip& clip, const std::string& name, std::vector<std::string>& notices) {
  const ClipMotion& motion = clip.motion;
  const bool has_still = motion.still_share >= kMinStill;
  if (has_still && motion.camera_px / clip.scale > kCameraPx)
    throw Error(ErrorKind::kInput, name,
                fmt::format("the camera moves: what does not flow goes {:.1f} px a frame, up to {:.1f}",
                            motion.camera_px / clip.scale, motion.camera_max_px / clip.scale),
                "Steady the clip first, choose a part in which the camera stands still with --from and "
                "--input-frames, or go on regardless with --moving-camera");
  if (!has_still && motion.alike_share > kMaxAlike && motion.alike_px / clip.scale > kCameraPx)
    throw Error(ErrorKind::kInput, name,
                fmt::format("the camera moves: nothing stands still, and {:.0f} % of the picture goes "
                            "{:.1f} px a frame alike",
                            100 * motion.alike_share, motion.alike_px / clip.scale),
                "Steady the clip first; or go on regardless with --moving-camera, where it is a sky that "
                "drifts as one");
  if (!has_still)
    notices.push_back(
        "nothing in the picture stands still: if that is the camera's motion, steady the clip first");
}

}  // namespace freshet::synth::flowlines
