#include "freshet/animate.h"

#include "freshet/error.h"
#include "freshet/picture.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "synth/animate/animate.h"
#include "synth/animate/staging.h"

namespace freshet {

AnimateReport animate(const Labelling& labelling, const std::function<void(const cv::Mat&)>& sink,
                      const AnimateOptions& options, const Job& job) {
  const OneOpenCvThread one;
  const Search::Impl& search = labelling.impl().search.impl();
  if (options.loop && search.frames < 2)
    throw Error(ErrorKind::kUsage, "loop", "one frame is no animation to go round", "Search for 2 or more");
  synth::animate::AnimateOptions rendering;
  rendering.frames = search.frames;
  rendering.fps = search.fps;
  rendering.loop = options.loop;
  rendering.memory_bytes = options.memory_bytes;
  if (options.moving_outline) {
    rendering.boundary.boundary = synth::animate::Boundary::kMoving;
    rendering.boundary.background = options.background;
  }
  const store::Snapshot& snapshot = search.store.impl().snapshot;
  const synth::animate::Staging staging =
      synth::animate::stage(snapshot, labelling.impl().assignment, search.picture.size(),
                            query::guide_of_animation(search.request, search.picture.size()),
                            {.factor = options.speed, .map = options.retiming_map}, rendering);
  const synth::animate::AnimateReport report =
      synth::animate::animate(snapshot, search.base->settings, search.picture, search.matte,
                              staging.placement, staging.options, sink, job.progress, job.stop);
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
