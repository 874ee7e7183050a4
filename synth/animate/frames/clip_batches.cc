#include "synth/animate/frames/clip_batches.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

namespace freshet::synth::animate {
namespace {

constexpr int kMaxSamples = 12, kMinSamples = 4;
constexpr int kSampledPixels = 32 << 20;  // in all of them

/// As many output frames as fit into the memory that the picture's own planes leave.
int batch_of(const std::vector<std::unique_ptr<ClipLayer>>& layers, cv::Size picture, cv::Size canvas,
             const FrameOptions& options) {
  double fixed = static_cast<double>(kPictureBytesPerPixel) * picture.area(), clip_bytes = 0;
  for (const auto& layer : layers) {
    fixed += static_cast<double>(layer->average_bytes());
    clip_bytes = std::max(clip_bytes, static_cast<double>(layer->bytes_per_output()));
  }
  const double per_frame = canvas.area() * sizeof(float) * 4 / 3.0 + clip_bytes;
  const double fit = (static_cast<double>(options.memory_bytes) - fixed) / per_frame;
  if (fit >= options.frames) return options.frames;
  // In slabs of 16: a tile is decoded for all of its frames.
  return std::min(options.frames, std::max(16, static_cast<int>(fit) / 16 * 16));
}

/// A region's histograms hold as many pixels whatever the picture's size; samples of a large picture would not fit, and
/// need not be as many.
std::vector<int> samples_of(int frames, cv::Size picture) {
  const int count = std::min({frames, kMaxSamples, std::max(kMinSamples, kSampledPixels / picture.area())});
  std::vector<int> samples;
  for (int i = 0; i < count; ++i) samples.push_back(i * frames / count);
  return samples;
}

}  // namespace

std::vector<std::unique_ptr<ClipLayer>> clip_layers(const Animation& animation, const Placement& placement,
                                                    Resampling resampling, ClipDetail detail) {
  std::map<store::ClipId, std::vector<std::size_t>> patches_of;
  for (std::size_t p = 0; p < placement.patches.size(); ++p)
    patches_of[placement.patches[p].clip].push_back(p);
  const FrameOptions& options = animation.options;
  std::vector<std::unique_ptr<ClipLayer>> layers;
  for (auto& [clip, patches] : patches_of) {
    // Cross-fades of different clips should not fall together: steps of the golden ratio spread them.
    const double phase = std::fmod(0.618034 * static_cast<double>(layers.size()), 1.0);
    layers.push_back(std::make_unique<ClipLayer>(
        animation.snapshot, clip, animation.settings.flow_step, placement, std::move(patches),
        playing::TimelineOptions{
            .frames = options.frames, .fps = options.fps, .loop = options.loop, .phase = phase},
        resampling, detail, options.tiles.get()));
  }
  return layers;
}

void add_motion(const Animation& animation, const ClipLayer& layer, MotionSums& sums) {
  const ClipLuma& luma = layer.luma();
  const HeldFlow held{luma.flow_region(), [&luma](std::uint32_t frame) { return luma.flow(frame); }};
  for (const ClipLayer::Played& group : layer.played()) {
    const PlacedPatch& one = animation.placement.patches[group.patches.front()];
    PlayedPatches played{.clip = one.clip, .patches = group.patches, .shown = {}};
    const std::uint32_t last = animation.snapshot.clip(one.clip).flow.frames - 1;
    bool all_held = true;
    for (const playing::Moment& moment : group.moments) {
      // In a cross-fade the louder of the two moments moves the fluid.
      const auto at = static_cast<std::uint32_t>(moment.louder());
      played.shown.push_back({.frame = at, .rate = one.speed});
      all_held = all_held && luma.holds_flow(std::min(at, last));
    }
    sums.add(played, all_held ? &held : nullptr);
  }
}

ClipBatches::ClipBatches(Animation& animation, const Placement& placement, Resampling resampling,
                         ClipDetail detail, const BlendOptions& options)
    : animation_(animation),
      layers_(clip_layers(animation, placement, resampling, detail)),
      batch_(batch_of(layers_, animation.picture.size(), canvas_of(placement).size(), animation.options)),
      samples_(samples_of(animation.options.frames, animation.picture.size())),
      slot_(static_cast<std::size_t>(animation.options.frames), 0),
      blender_(placement, std::max(batch_, static_cast<int>(samples_.size())), options) {
  animation.report.clips = layers_.size();
}

bool ClipBatches::in_one() const { return batch_ == animation_.options.frames; }

void ClipBatches::begin(int needed, bool with_samples,
                        const std::function<void(ClipLayer&, std::span<const int> kept)>& measure) {
  std::vector<int> kept = samples_;
  if (in_one()) {
    kept.resize(static_cast<std::size_t>(needed));
    std::iota(kept.begin(), kept.end(), 0);
  }
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    animation_.throw_if_stopped();
    animation_.tell("blend", i, layers_.size());
    measure(*layers_[i], kept);
    // Samples that nobody fits a model to would be left in the blender.
    if (in_one() || with_samples)
      merge(*layers_[i], kept);
    else
      layers_[i]->release();
  }
  animation_.tell("blend", layers_.size(), layers_.size());
  take_lap();
}

void ClipBatches::read(std::span<const int> outputs) {
  if (in_one()) return;
  for (const auto& layer : layers_) merge(*layer, outputs);
  take_lap();
}

void ClipBatches::merge(ClipLayer& layer, std::span<const int> outputs) {
  animation_.throw_if_stopped();
  for (std::size_t i = 0; i < outputs.size(); ++i)
    slot_[static_cast<std::size_t>(outputs[i])] = static_cast<int>(i);
  layer.add(outputs, blender_);
  layer.release();
}

void ClipBatches::take_lap() {
  double read = 0;
  for (const auto& layer : layers_) read += layer->read_s();
  animation_.report.decode_s += read - read_s_;
  animation_.report.blend_s += animation_.watch.lap() - (read - read_s_);
  read_s_ = read;
}

}  // namespace freshet::synth::animate
