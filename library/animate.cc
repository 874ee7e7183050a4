#include "freshet/animate.h"

#include <optional>

#include "freshet/error.h"
#include "freshet/picture.h"
#include "library/animation.h"
#include "library/checks.h"
#include "library/opencv_threads.h"
#include "library/states.h"
#include "media/picture/passes.h"
#include "media/picture/picture.h"
#include "query/labelling/shown_kind.h"
#include "synth/animate/animate.h"
#include "synth/animate/staging.h"
#include "synth/outline/moving_outline.h"
#include "synth/takes/pace.h"

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

void check(const AnimateOptions& options, const Search::Impl& search) {
  if (options.loop && search.frames < 2)
    throw Error(ErrorKind::kUsage, "loop", "one frame is no animation to go round", "Search for 2 or more");
  if (options.speed) check_range("speed", *options.speed, 0.05, 20);
  check_word("pace", options.pace, {"auto", "slow", "natural", "fast"});
  check_deep(options.deep, search.picture);
}

double factor_of(const Labelling& labelling, const AnimateOptions& options, const query::MotionGuide& guide) {
  if (options.speed) return *options.speed;
  const Search::Impl& search = labelling.impl().search.impl();
  const query::Assignment& assignment = labelling.impl().assignment;
  const std::string& asked = search.request.options.candidates.class_name;
  return synth::takes::paced(search.store.impl().snapshot, search.base->settings, assignment, search.matte,
                             options.pace, query::shown_kind(asked, search.kind, assignment).name,
                             !guide.speed.empty())
      .factor;
}

synth::outline::MovingOutlineOptions outline_of(const AnimateOptions& options, const Search::Impl& search) {
  synth::outline::MovingOutlineOptions outline;
  outline.held = search.held;
  if (options.moving_outline) {
    outline.kind = synth::outline::Outline::kMoving;
    outline.background = rendered(options.background);
  }
  return outline;
}

}  // namespace

synth::animate::AnimateReport render_animation(const Labelling& labelling, const AnimateOptions& options,
                                               const cv::Mat& picture, synth::animate::FrameForm form,
                                               const std::function<void(const cv::Mat&)>& sink,
                                               const Job& job) {
  const Search::Impl& search = labelling.impl().search.impl();
  synth::animate::AnimateOptions rendering;
  rendering.form = form;
  rendering.frames = search.frames;
  rendering.fps = search.fps;
  rendering.loop = options.loop;
  rendering.memory_bytes = options.memory_bytes;
  rendering.outline = outline_of(options, search);
  const store::Snapshot& snapshot = search.store.impl().snapshot;
  const query::MotionGuide guide = query::guide_of_animation(search.request, search.picture.size());
  const synth::animate::Staging staging = synth::animate::stage(
      snapshot, labelling.impl().assignment, search.picture.size(), guide,
      {.factor = factor_of(labelling, options, guide), .map = options.retiming_map}, rendering);
  return synth::animate::animate(snapshot, search.base->settings, picture, search.matte, staging.placement,
                                 staging.options, sink, job.progress, job.stop);
}

AnimateReport animate(const Labelling& labelling, const std::function<void(const cv::Mat&)>& sink,
                      const AnimateOptions& options, const Job& job) {
  const OneOpenCvThread one;
  const Search::Impl& search = labelling.impl().search.impl();
  check(options, search);
  const bool deep = !options.deep.empty();
  const cv::Mat picture = rendered(deep ? options.deep : search.picture);
  std::optional<media::Layers> layers;
  if (deep)
    layers.emplace(options.moving_outline
                       ? synth::outline::behind_fluid(picture, search.matte, outline_of(options, search))
                       : picture,
                   options.deep, search.matte, media::Layer::kWhole, media::AlphaForm::kStraight,
                   options.deep.depth() == CV_16U ? media::Samples::k16 : media::Samples::kLight);
  const synth::animate::AnimateReport report = render_animation(
      labelling, options, picture,
      deep ? synth::animate::FrameForm::kFluid : synth::animate::FrameForm::kWhole,
      [&](const cv::Mat& frame) { sink(layers ? layers->frame(frame) : frame); }, job);
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
