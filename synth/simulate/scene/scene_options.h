// synth/simulate/scene/scene_options.h — what to simulate: a clip or a design; its size, length and seed.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <opencv2/core.hpp>

#include "synth/simulate/scene/design.h"

namespace freshet::synth::simulate {

/// The ready-made clips, and a design of one's own.
enum class SceneKind {
  kSmoke,
  kFire,
  kInk,
  kWaterfall,
  kRiver,
  kClouds,
  kSea,
  kRain,
  kFountain,
  kBreakers,
  kDesign
};

/// How a ready-made clip departs from what its seed draws.
struct ClipVariation {
  /// 0.1 to 10: of all motion. Fluids that are solved take more steps per frame, so that their forms stay.
  float speed = 1.0f;
  /// 0.2 to 5: size of all forms, as if the camera were that much nearer. Speeds in px grow with it.
  float zoom = 1.0f;
  /// 0.1 to 10: how much fluid there is: opacity of smoke, width of fires, water in a fall, foam of a river, cover of
  /// clouds, height of waves, drops of rain and fountains.
  float amount = 1.0f;
  bool operator==(const ClipVariation&) const = default;
};

struct SceneOptions {
  SceneKind kind = SceneKind::kSmoke;
  cv::Size size{640, 360};  // px, 16..4096 each way, odd sizes allowed
  int frames = 120;         // at least 1
  /// 1..240. Speeds are set in picture heights per second, so motion per frame shrinks with it.
  double fps = 25.0;
  std::uint64_t seed = 1;     // moves sources, winds, speeds, rocks and palette; any value
  ClipVariation variation{};  // of clips; designs say such things themselves
  int warm_up_frames = -1;    // simulated before frame 0; -1: as many as the preset needs to be developed
  Design design{};            // of SceneKind::kDesign
  int alpha_bits = 8;         // or 16, which only designs have
};

/// A clip by its name, as scene_kind_name says it. Throws Error{kUsage} that lists them.
SceneKind parse_scene_kind(std::string_view name);
std::string_view scene_kind_name(SceneKind kind);
std::span<const SceneKind> all_clip_kinds();

/// Throws Error{kUsage} naming the option that is out of range.
void check(const SceneOptions& options);

}  // namespace freshet::synth::simulate
