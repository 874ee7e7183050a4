// synth/simulate/scene/scene_options.cc
#include "synth/simulate/scene/scene_options.h"

#include <array>

#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::synth::simulate {
namespace {

constexpr std::array<SceneKind, 10> kClipKinds{
    SceneKind::kSmoke,  SceneKind::kFire, SceneKind::kInk,  SceneKind::kWaterfall, SceneKind::kRiver,
    SceneKind::kClouds, SceneKind::kSea,  SceneKind::kRain, SceneKind::kFountain,  SceneKind::kBreakers};
constexpr std::array<std::string_view, 10> kNames{"smoke",  "fire", "ink",  "waterfall", "river",
                                                  "clouds", "sea",  "rain", "fountain",  "breakers"};
constexpr int kMinSide = 16, kMaxSide = 4096;
constexpr int kMaxFrames = 1'000'000, kMaxWarmUp = 100'000;

}  // namespace

SceneKind parse_scene_kind(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return kClipKinds[i];
  }
  throw Error(ErrorKind::kUsage, "preset", fmt::format("'{}' is not known", name),
              fmt::format("Choose one of {}", fmt::join(kNames, ", ")));
}

std::string_view scene_kind_name(SceneKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

std::span<const SceneKind> all_clip_kinds() { return kClipKinds; }

void check(const SceneOptions& options) {
  const auto refuse = [](const char* option, const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kUsage, option, fault, remedy);
  };
  const auto in_range = [](int side) { return side >= kMinSide && side <= kMaxSide; };
  if (!in_range(options.size.width) || !in_range(options.size.height)) {
    refuse("size", fmt::format("{}x{} is out of range", options.size.width, options.size.height),
           fmt::format("Each side must be {} to {} pixels", kMinSide, kMaxSide));
  }
  if (options.frames < 1 || options.frames > kMaxFrames) {
    refuse("frames", fmt::format("{} is out of range", options.frames),
           fmt::format("Ask for 1 to {} frames", kMaxFrames));
  }
  if (!(options.fps >= 1.0 && options.fps <= 240.0)) {
    refuse("fps", fmt::format("{} is out of range", options.fps), "Give 1 to 240 frames per second");
  }
  if (options.warm_up_frames < -1 || options.warm_up_frames > kMaxWarmUp) {
    refuse("warm-up", fmt::format("{} is out of range", options.warm_up_frames),
           fmt::format("Give 0 to {} frames, or -1 for the preset's own", kMaxWarmUp));
  }
  const auto vary = [&](const char* option, float value, float least, float most) {
    if (!(value >= least && value <= most))
      refuse(option, fmt::format("{} is out of range", value), fmt::format("Give {} to {}", least, most));
  };
  vary("speed", options.variation.speed, 0.1f, 10.0f);
  vary("zoom", options.variation.zoom, 0.2f, 5.0f);
  vary("amount", options.variation.amount, 0.1f, 10.0f);
  if (options.kind == SceneKind::kDesign && options.variation != ClipVariation{})
    refuse("speed, zoom, amount", "only the ready-made clips have them", "Change the design itself");
  if (options.alpha_bits != 8 && !(options.alpha_bits == 16 && options.kind == SceneKind::kDesign)) {
    refuse("alpha-bits", fmt::format("{} cannot be had", options.alpha_bits),
           "Give 8, or 16 for a design; the ready-made clips have 8");
  }
}

}  // namespace freshet::synth::simulate
