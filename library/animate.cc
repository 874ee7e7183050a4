#include "freshet/animate.h"

#include <optional>

#include "freshet/error.h"
#include "freshet/picture.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "media/picture/passes.h"
#include "media/picture/picture.h"
#include "synth/animate/animate.h"
#include "synth/animate/staging.h"
#include "synth/outline/moving_outline.h"

namespace freshet {

namespace {

/// A picture of 8 bits, or a deeper one in the units that are rendered in.
cv::Mat rendered(const cv::Mat& picture) {
  if (picture.empty() || picture.depth() == CV_8U) return picture;
  return media::coded_picture({.bgr = {}, .deep = picture, .alpha = {}, .reduction = {}, .notices = {}});
}

void check_deep(const cv::Mat& deep, const cv::Mat& picture) {
  if (deep.empty()) return;
  if (deep.size() != picture.size() || (deep.type() != CV_16UC3 && deep.type() != CV_32FC3))
    throw Error(ErrorKind::kUsage, "the deep picture",
                "CV_16UC3 or CV_32FC3 of the size of the picture that was searched with is expected");
}

}  // namespace

AnimateReport animate(const Labelling& labelling, const std::function<void(const cv::Mat&)>& sink,
                      const AnimateOptions& options, const Job& job) {
  const OneOpenCvThread one;
  const Search::Impl& search = labelling.impl().search.impl();
  if (options.loop && search.frames < 2)
    throw Error(ErrorKind::kUsage, "loop", "one frame is no animation to go round", "Search for 2 or more");
  check_deep(options.deep, search.picture);
  synth::animate::AnimateOptions rendering;
  rendering.frames = search.frames;
  rendering.fps = search.fps;
  rendering.loop = options.loop;
  rendering.memory_bytes = options.memory_bytes;
  rendering.outline.held = search.held;
  if (options.moving_outline) {
    rendering.outline.kind = synth::outline::Outline::kMoving;
    rendering.outline.background = rendered(options.background);
  }
  const bool deep = !options.deep.empty();
  const cv::Mat picture = rendered(deep ? options.deep : search.picture);
  std::optional<media::Layers> layers;
  if (deep) {
    rendering.form = synth::animate::FrameForm::kFluid;
    layers.emplace(options.moving_outline
                       ? synth::outline::behind_fluid(picture, search.matte, rendering.outline)
                       : picture,
                   options.deep, search.matte, media::Layer::kWhole, media::AlphaForm::kStraight,
                   options.deep.depth() == CV_16U ? media::Samples::k16 : media::Samples::kLight);
  }
  const store::Snapshot& snapshot = search.store.impl().snapshot;
  const synth::animate::Staging staging =
      synth::animate::stage(snapshot, labelling.impl().assignment, search.picture.size(),
                            query::guide_of_animation(search.request, search.picture.size()),
                            {.factor = options.speed, .map = options.retiming_map}, rendering);
  const synth::animate::AnimateReport report = synth::animate::animate(
      snapshot, search.base->settings, picture, search.matte, staging.placement, staging.options,
      [&](const cv::Mat& frame) { sink(layers ? layers->frame(frame) : frame); }, job.progress, job.stop);
  return {.frames = search.frames, .clips = report.clips, .pieces = report.pieces, .seconds = report.total_s};
}

AnimateReport animate(const Labelling& labelling, const std::filesystem::path& video,
                      const AnimateOptions& options, const Job& job) {
  const Search::Impl& search = labelling.impl().search.impl();
  VideoWriter writer(video, search.picture.size(), {.frames = search.frames, .fps = search.fps});
  const AnimateReport report = animate(
      labelling, [&](const cv::Mat& frame) { writer.write(frame); }, options, job);
  writer.finish();
  return report;
}

}  // namespace freshet
