#include "synth/scene/measured/measured_plants.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/video/video_reader.h"
#include "store/store.h"
#include "stored/clip_frames.h"
#include "synth/scene/cycle.h"
#include "synth/scene/measured/clip_sway.h"
#include "synth/scene/measured/sway_fit.h"
#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {
namespace {

constexpr std::size_t kFewestFrames = 32, kMostFrames = 1500;
constexpr double kStands = 1e-3;  // deviation, lengths of the armature: optical flow errs by as much
constexpr double kMostNoise =
    0.1;  // of the variance; blades that hide each other have a third, a spike nothing

struct Sway {
  std::vector<std::vector<float>> tips;
  double fps = 0;
};

void stop_if_asked(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Error(ErrorKind::kCancelled, "scene", "stopped");
}

Sway sway_of_video(const TreeMotion& tree, const std::stop_token& stop) {
  media::VideoReader reader(tree.motion_from);
  std::size_t count = 0;
  const auto next = [&]() -> std::optional<cv::Mat> {
    if (count++ == kMostFrames) return {};
    stop_if_asked(stop);
    const std::optional<media::Frame> frame = reader.next();
    if (!frame) return {};
    return media::to_luma(*frame);
  };
  std::vector<std::vector<float>> tips = clip_sway(next, tree.motion_armatures, tree.motion_from.string());
  return {std::move(tips),
          static_cast<double>(reader.info().fps_num) / static_cast<double>(reader.info().fps_den)};
}

Sway sway_of_clip(const TreeMotion& tree, const std::stop_token& stop) {
  constexpr std::uint32_t kSlab = 16;  // frames of a run of tiles: read together they are decoded once
  const store::Snapshot snapshot = store::Store::open_read(tree.motion_from).snapshot();
  const std::optional<store::ClipId> id = snapshot.find(tree.motion_clip);
  if (!id)
    throw Error(ErrorKind::kNotFound, tree.motion_clip,
                "the store " + tree.motion_from.string() + " has no clip of this name",
                "freshet store info lists its clips");
  const stored::ClipFrames frames(snapshot, *id);
  std::vector<cv::Mat> slab;
  std::uint32_t at = 0;
  const auto next = [&]() -> std::optional<cv::Mat> {
    if (at == frames.size() || at == kMostFrames) return {};
    stop_if_asked(stop);
    if (at % kSlab == 0) slab = frames.read_luma(at, std::min(kSlab, frames.size() - at));
    return slab[at++ % kSlab];
  };
  const store::ClipRecord& record = snapshot.clip(*id);
  std::vector<std::vector<float>> tips = clip_sway(next, tree.motion_armatures, tree.motion_clip);
  return {std::move(tips), static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den)};
}

/// Of the scene's strongest wind, on what gives way as the film's plants do.
double strength_of(const Wind& wind, const std::vector<Line>& armatures) {
  double sum = 0;
  for (const Line& line : armatures) {
    const cv::Point2d way = (line.to - line.from) / cv::norm(line.to - line.from);
    sum += force_strength(wind, {-way.y, way.x});
  }
  return sum / static_cast<double>(armatures.size());
}

}  // namespace

void measure_plants(Scene& scene, std::vector<std::string>* notices, const std::stop_token& stop) {
  const Wind wind = Weather(scene.wind, cycle_of(scene)).strongest();
  for (SceneLayer& layer : scene.layers) {
    auto* tree = layer.as<TreeMotion>();
    if (tree == nullptr || tree->motion_from.empty()) continue;
    const std::string film = tree->motion_clip.empty() ? tree->motion_from.string() : tree->motion_clip;
    const Sway sway = tree->motion_clip.empty() ? sway_of_video(*tree, stop) : sway_of_clip(*tree, stop);
    const std::size_t count = sway.tips[0].size();
    if (count < kFewestFrames || static_cast<double>(count) < kLeastSeenS * sway.fps)
      throw Error(ErrorKind::kInput, film,
                  fmt::format("its {} frames are too few to see how a plant sways", count),
                  fmt::format("Give {:.0f} frames or more, better some seconds",
                              std::max<double>(kFewestFrames, kLeastSeenS * sway.fps)));
    Wind blows = wind;
    if (!(blows.speed_m_per_s > 0 && blows.turbulence > 0)) blows = {};
    const SwayFit fit = fit_sway(sway.tips, sway.fps, blows, strength_of(blows, tree->motion_armatures));
    if (fit.deviation < kStands)
      throw Error(
          ErrorKind::kInput, film,
          fmt::format("the plant of layer {} does not sway in it: its tip moves by {:.2g} of its length",
                      layer.name, fit.deviation),
          "Draw motion_armature along what moves, or give another film");
    if (fit.noise > kMostNoise)
      throw Error(
          ErrorKind::kInput, film,
          fmt::format("the plant of layer {} is lost from sight in it: {:.0f} % of what it seems to move "
                      "is noise",
                      layer.name, 100 * fit.noise),
          "Draw motion_armature along a broader plant that nothing hides, or give another film");
    tree->frequency_hz = fit.frequency_hz;
    tree->damping_per_s = fit.damping_per_s;
    tree->mass = fit.mass;
    if (notices != nullptr)
      notices->push_back(
          fmt::format("layer {}: in {} s of {} the tip sways by {:.3f} of its length: frequency = {:.3g}, "
                      "damping = {:.3g}, "
                      "mass = {:.3g}",
                      layer.name, std::round(10 * static_cast<double>(count) / sway.fps) / 10, film,
                      fit.deviation, fit.frequency_hz, fit.damping_per_s, fit.mass));
  }
}

}  // namespace freshet::synth::scene
