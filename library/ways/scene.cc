#include "freshet/ways/scene.h"

#include <optional>
#include <stop_token>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "hints/stroke_field.h"
#include "library/animation.h"
#include "library/opencv_threads.h"
#include "media/picture/picture.h"
#include "synth/scene/frames/made_frames.h"
#include "synth/scene/measured/measured_plants.h"
#include "synth/scene/printed_scene.h"
#include "synth/scene/rendering/scene_animation.h"
#include "synth/scene/rendering/scene_cut.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"

namespace freshet {
namespace {

namespace scene = synth::scene;

MotionGuide guide_of(const scene::PatchesTarget& target, const std::string& where) {
  const std::optional<Horizon> horizon =
      find_horizon(target.picture, target.matte, target.motion->class_name);
  if (!target.motion->strokes.empty())
    return read_strokes(target.motion->strokes, target.picture.size(), nullptr, horizon);
  MotionGuide guide;
  guide.horizon = horizon;
  if (target.strokes.empty()) return guide;
  const hints::StrokeField field =
      hints::interpolate(target.strokes, target.picture.size(), where, {.horizon = horizon});
  guide.direction = field.direction;
  guide.speed = field.speed;
  return guide;
}

/// A layer of patches, made as a picture is.
void make_patches(const scene::PatchesTarget& target, const scene::PushedFrames::Sinks& sinks,
                  const std::stop_token& stop) {
  const std::string where = fmt::format("{}: layer {}", target.scene->file.string(), target.layer->name);
  const OneOpenCvThread one;
  const Job job{.progress = {}, .stop = stop};
  const Labelling labelling = label(search(Store(target.motion->store), target.picture, target.matte,
                                           {.class_name = target.motion->class_name,
                                            .guide = guide_of(target, where),
                                            .frames = target.scene->frames,
                                            .fps = target.scene->fps},
                                           job),
                                    {}, job);
  render_animation(labelling, {.loop = target.scene->loop}, target.picture, synth::animate::FrameForm::kFluid,
                   sinks.frame, job);
}

void refuse_words(const scene::Scene& asked) {
  for (const scene::SceneLayer& layer : asked.layers)
    if (const auto* motion = layer.as<scene::PatchesMotion>(); motion != nullptr && !motion->options.empty())
      throw Error(ErrorKind::kUsage, fmt::format("{}: layer {}", asked.file.string(), layer.name),
                  "its options are the program's", "Take them out, or run freshet synth scene");
}

}  // namespace

struct SceneFilm::Impl {
  Impl(const std::filesystem::path& file, const SceneOptions& options, const Job& job)
      : light(options.light),
        asked(options.as_printed ? scene::read_printed_scene(file) : scene::read_scene(file)),
        patches([stop = stopped.get_token()](const scene::PatchesTarget& target,
                                             const scene::PushedFrames::Sinks& sinks) {
          make_patches(target, sinks, stop);
        }) {
    refuse_words(asked);
    const media::Still still = media::read_still(asked.picture);
    size = still.bgr.size();
    for (const std::string& notice : still.notices) notices.push_back(asked.picture.string() + ": " + notice);
    scene::read_marks(asked, size, &notices);
    scene::measure_plants(asked, &notices, job.stop);
    const std::vector<scene::LayerPixels> pixels = scene::cut_scene(
        asked, still, {},
        [&](std::size_t layer, const std::string&) {
          if (job.progress) job.progress({"cutting layers", layer, asked.layers.size()});
        },
        &notices, job.stop);
    for (const scene::SceneLayer& layer : asked.layers) names.push_back(layer.name);
    animation.emplace(
        asked, pixels, size,
        [&](const scene::SceneLayer& layer, const scene::LayerPixels& own) {
          return scene::frames_of_layer(asked, layer, own, patches, job.stop);
        },
        &notices);
  }
  ~Impl() { stopped.request_stop(); }

  bool light;
  std::stop_source stopped;  // of what is made beside the rendering
  scene::Scene asked;
  scene::PatchesMaker patches;
  cv::Size size;
  std::vector<std::string> names, notices;
  std::optional<scene::SceneAnimation> animation;  // borrows all of these
  int shown = 0;
};

SceneFilm::SceneFilm(const std::filesystem::path& scene, const SceneOptions& options, const Job& job) {
  const OneOpenCvThread one;
  impl_ = std::make_unique<Impl>(scene, options, job);
}
SceneFilm::~SceneFilm() = default;

cv::Size SceneFilm::size() const { return impl_->size; }
int SceneFilm::frames() const { return impl_->asked.frames; }
double SceneFilm::fps() const { return impl_->asked.fps; }
const std::vector<std::string>& SceneFilm::layers() const { return impl_->names; }
const std::vector<std::string>& SceneFilm::notices() const { return impl_->notices; }

bool SceneFilm::next(cv::Mat& frame) {
  if (impl_->shown == frames()) return false;
  const OneOpenCvThread one;
  frame.create(size(), impl_->light ? CV_32FC4 : CV_8UC3);
  impl_->animation->render(impl_->shown, frame);
  ++impl_->shown;
  return true;
}

cv::Mat SceneFilm::layer(std::size_t i) const {
  if (impl_->shown == 0 || i >= impl_->names.size())
    throw Error(ErrorKind::kUsage, fmt::format("layer {}", i),
                impl_->shown == 0 ? "no frame was given yet" : "there is no such layer");
  cv::Mat out;
  impl_->animation->layer(i, out);
  return out;
}

}  // namespace freshet
