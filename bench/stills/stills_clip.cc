#include "bench/stills/stills_clip.h"

#include <opencv2/imgproc.hpp>

#include "media/frame/frame.h"
#include "media/video/video_reader.h"
#include "synth/simulate/simulate.h"
#include "synth/stills/region_proposal.h"

namespace freshet::bench {

StillsClip read_stills_clip(const std::filesystem::path& path, int width, int most) {
  StillsClip clip{.name = path.stem().string(), .frames = {}};
  media::VideoReader reader(path);
  clip.fps = static_cast<double>(reader.info().fps_num) / static_cast<double>(reader.info().fps_den);
  while (static_cast<int>(clip.frames.size()) < most) {
    const auto frame = reader.next();
    if (!frame) break;
    const cv::Mat bgr = media::to_bgr(*frame);
    const double scale = std::min(1.0, static_cast<double>(width) / bgr.cols);
    cv::Mat small;
    cv::resize(bgr, small, {cvRound(bgr.cols * scale) / 16 * 16, cvRound(bgr.rows * scale) / 16 * 16}, 0, 0,
               cv::INTER_AREA);
    clip.frames.push_back(small);
  }
  return clip;
}

StillsClip simulated_stills_clip(const std::string& scene, cv::Size size, int frames) {
  namespace simulate = synth::simulate;
  StillsClip clip{.name = "simulated " + scene, .frames = {}, .fps = 25};
  simulate::Simulation simulation({.kind = simulate::parse_scene_kind(scene),
                                   .size = size,
                                   .frames = frames,
                                   .fps = clip.fps,
                                   .seed = 3});
  for (simulate::SimulatedFrame frame; simulation.next(frame);) clip.frames.push_back(frame.picture.clone());
  return clip;
}

std::vector<std::filesystem::path> stills_clips(const std::filesystem::path& footage) {
  std::vector<std::filesystem::path> clips;
  for (const char* name :
       {"fire/candle_yellow.mp4", "fire/flames_wall_black.mp4", "fire/campfire_logs_black.mp4",
        "water/waterfall_dusk_pool.mp4", "water/river_rapids_turquoise.mp4", "water/sea_surface_dark.mp4",
        "water/shore_aerial_foam.mp4", "clouds/cumulus_blue.mp4", "clouds/clouds_sun_dark.mp4",
        "smoke/chimney_plume_grey.mp4"})
    clips.push_back(footage / "clips" / name);
  return clips;
}

cv::Mat moving_mask(const std::vector<cv::Mat>& frames) {
  std::vector<cv::Mat> some;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, frames.size() / 24))
    some.push_back(frames[i]);
  const cv::Mat variation = synth::stills::variation_of(some);
  double most = 0;
  cv::minMaxLoc(variation, nullptr, &most);
  cv::Mat mask = variation > .2 * most;
  return mask;
}

}  // namespace freshet::bench
