#include "studio/ways/live_layers.h"

#include <algorithm>
#include <cstdint>

#include <opencv2/imgcodecs.hpp>

#include "freshet/error.h"
#include "studio/drawing/reduced.h"
#include "studio/ways/way.h"
#include "synth/scene/frames/made_frames.h"
#include "synth/scene/rendering/scene_cut.h"
#include "synth/scene/scene_file.h"
#include "synth/scene/scene_marks.h"

namespace freshet::studio {
namespace {

namespace scene = synth::scene;

constexpr int kSide = 640;    // px: the longer side
constexpr int kFrames = 300;  // at most: a page holds them all
constexpr const char* kFolder = "live";
constexpr const char* kPicture = "picture.png";

/// What of it moves soon.
DrawnScene lively(DrawnScene drawn) {
  drawn.frames = std::min(drawn.frames, kFrames);
  for (DrawnLayer& layer : drawn.layers) {
    if (layer.motion == "patches") layer.motion = "still";
    layer.sway_clip.clear();  // measured for seconds
  }
  return drawn;
}

bool cuts(const WayFile& file) { return file.name.ends_with(".png"); }

/// What its layers are cut by.
std::string cut_key(const DrawnScene& drawn, const std::vector<WayFile>& files) {
  std::string key;
  for (const DrawnLayer& layer : drawn.layers)
    key += layer.name + '\n' + layer.motion + '\n' + std::to_string(static_cast<int>(layer.matte)) + '\n';
  for (const WayFile& file : files)
    if (cuts(file)) key += file.name + '\n' + file.bytes;
  return key;
}

void stop_if_asked(const Job& job) {
  if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "layers", "stopped");
}

}  // namespace

void LiveLayers::render(const Document& document, const cv::Mat& picture, int first, const Places& places,
                        const Job& job) {
  const double factor = reduction(picture.size(), kSide);
  if (still_.bgr.empty()) {
    still_.bgr = reduced(picture, factor);
    std::vector<std::uint8_t> png;
    cv::imencode(".png", still_.bgr, png, {cv::IMWRITE_PNG_COMPRESSION, 1});
    places.write(kFolder, {{kPicture, {png.begin(), png.end()}}});
  }
  const cv::Size size = still_.bgr.size();
  Document small;
  small.scene = lively(reduced(document.scene, factor));
  small.design = document.design;
  small.flowlines = document.flowlines;
  RecipeFiles named;
  named.picture = std::string("ways/") + kFolder + "/" + kPicture;
  std::vector<WayFile> files = way_of("scene").files(
      {.document = small, .picture = still_.bgr, .files = named, .folder = places.project});
  const std::string key = cut_key(small.scene, files);
  if (key == cut_by_) std::erase_if(files, cuts);  // they lie there
  places.write(kFolder, files);
  scene::Scene asked = scene::read_scene(places.project / "ways" / kFolder / "scene.toml");
  scene::read_marks(asked, size);
  if (key != cut_by_) {
    if (job.progress) job.progress({"cutting layers", 0, 0});
    cut_by_.clear();
    // The eye follows what moves: soft edges that are found in a tenth of the time do for it.
    pixels_ = scene::cut_scene(asked, still_, {.alpha = scene::AlphaMethod::kGuided}, {}, nullptr, job.stop);
    sprites_ = {};
    cut_by_ = key;
  }
  stop_if_asked(job);
  bool from_the_start = false;
  scene::SceneAnimation animation(
      asked, pixels_, size,
      [&](const scene::SceneLayer& layer, const scene::LayerPixels& own) {
        from_the_start = true;
        return scene::frames_of_layer(asked, layer, own, {}, job.stop);
      },
      nullptr, &sprites_);
  if (from_the_start) first = 0;
  first %= asked.frames;
  places.begin(size, asked.frames, asked.fps, first);
  cv::Mat frame(size, CV_8UC3);
  for (int i = 0; i < asked.frames; ++i) {
    stop_if_asked(job);
    animation.render((first + i) % asked.frames, frame);
    places.add(frame);
  }
}

}  // namespace freshet::studio
