#include "freshet/sample.h"

#include <algorithm>
#include <atomic>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>

#include "freshet/error.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "platform/random.h"
#include "stored/clip_frames.h"
#include "stored/patch_table.h"
#include "stored/patch_video.h"
#include "stored/store_settings.h"

namespace freshet {
namespace {

struct SampledClip {
  store::ClipId id;
  std::uint32_t moments;  // at which a video may begin
  media::PixelLayout layout;
  stored::ClipPatches patches;
};

struct Drawn {
  std::uint32_t clip, patch;
};

}  // namespace

struct Sampler::Impl {
  Store store;
  SamplerOptions options;
  std::vector<vision::Variant> variants;
  int side;
  std::vector<SampledClip> clips;
  std::vector<Drawn> drawn;  // of all shards, in their order

  std::size_t size() const { return (drawn.size() + options.shards - 1 - options.shard) / options.shards; }
  stored::PatchPlace place(std::size_t i) const {
    if (i >= size())
      throw Error(ErrorKind::kUsage, "sampler",
                  "video " + std::to_string(i) + " of " + std::to_string(size()));
    const std::size_t number = i * options.shards + options.shard;
    const Drawn& one = drawn[number];
    const SampledClip& clip = clips[one.clip];
    constexpr std::uint64_t kMoments = 1;  // stream of draws
    return {.clip = clip.id,
            .variant = variants[clip.patches.variant[one.patch]],
            .corner = {clip.patches.x[one.patch], clip.patches.y[one.patch]},
            .side = side,
            .first = static_cast<std::uint32_t>(Random(options.seed, kMoments).bits(number) % clip.moments),
            .count = static_cast<std::uint32_t>(options.frames)};
  }
  const Drawn& drawn_at(std::size_t i) const { return drawn[i * options.shards + options.shard]; }
};

Sampler::Sampler(const Store& store, const SamplerOptions& options) {
  if (options.frames < 1)
    throw Error(ErrorKind::kUsage, "sampler",
                std::to_string(options.frames) + " frames, and at least 1 is expected");
  if (options.shard >= options.shards)
    throw Error(ErrorKind::kUsage, "sampler",
                "shard " + std::to_string(options.shard) + " of " + std::to_string(options.shards) +
                    "; they are counted from 0");
  const store::Snapshot& snapshot = store.impl().snapshot;
  const vision::Settings settings = stored::settings_of(snapshot);
  Impl state{.store = store,
             .options = options,
             .variants = settings.variants(),
             .side = settings.grid.patch,
             .clips = {},
             .drawn = {}};
  for (const store::ClipId id : snapshot.clips()) {
    const store::ClipRecord& record = snapshot.clip(id);
    const auto frames = static_cast<std::uint32_t>(options.frames);
    if (record.frame_count < frames || record.rows == 0) continue;
    if (!options.class_name.empty() && record.class_name != options.class_name) continue;
    const auto number = static_cast<std::uint32_t>(state.clips.size());
    state.clips.push_back({.id = id,
                           .moments = record.frame_count - frames + 1,
                           .layout = stored::ClipFrames(snapshot, id).layout(),
                           .patches = stored::read_clip_patches(snapshot, settings, state.variants, id)});
    for (std::uint32_t patch = 0; patch < record.rows; ++patch) state.drawn.push_back({number, patch});
  }
  if (state.drawn.empty())
    throw Error(ErrorKind::kNotFound, store.path().string(),
                "no patch of " + std::to_string(options.frames) + " frames" +
                    (options.class_name.empty() ? "" : " in class " + options.class_name),
                "Ask for fewer frames, or another class");
  SplitMix64 random(options.seed);
  for (std::size_t left = state.drawn.size(); left > 1; --left)
    std::swap(state.drawn[left - 1], state.drawn[random.next() % left]);
  impl_ = std::make_shared<const Impl>(std::move(state));
}

std::size_t Sampler::size() const { return impl_->size(); }

int Sampler::side() const { return impl_->side; }

SampledPatch Sampler::at(std::size_t i) const {
  const stored::PatchPlace place = impl_->place(i);
  return {.clip = impl_->store.impl().snapshot.clip(place.clip).name,
          .patch = impl_->drawn_at(i).patch,
          .first = place.first};
}

cv::Mat Sampler::read(std::size_t first, std::size_t count, const Job& job) const {
  if (first > size() || count > size() - first)
    throw Error(ErrorKind::kUsage, "sampler",
                "videos " + std::to_string(first) + " to " + std::to_string(first + count) + " of " +
                    std::to_string(size()));
  const OneOpenCvThread one;
  const int side = impl_->side, frames = impl_->options.frames;
  const int shape[] = {static_cast<int>(count), frames, side, side};
  cv::Mat videos(4, shape, impl_->options.colour ? CV_8UC3 : CV_8U);
  const store::Snapshot& snapshot = impl_->store.impl().snapshot;
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "sampler", "stopped");
    const stored::PatchPlace place = impl_->place(first + i);
    const int one_shape[] = {frames, side, side};
    cv::Mat video(3, one_shape, videos.type(), videos.ptr(static_cast<int>(i)));
    stored::read_patch(snapshot, impl_->clips[impl_->drawn_at(first + i).clip].layout, place,
                       impl_->options.colour ? stored::Shown::kBgr : stored::Shown::kLuma, video);
  });
  return videos;
}

}  // namespace freshet
