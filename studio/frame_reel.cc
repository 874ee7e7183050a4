#include "studio/frame_reel.h"

#include <utility>
#include <variant>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "query/search/picture_scale.h"
#include "studio/clip_strip.h"
#include "studio/drawing/recipe.h"
#include "synth/animate/method_settings.h"
#include "synth/animate/motion/motion_field.h"

namespace freshet::studio {
namespace {

constexpr std::size_t kMemory = std::size_t{800} << 20;

/// The request's guide, of a picture reduced by `factor`.
query::MotionGuide guide_of(const query::LabelRequest& request, cv::Size labelled, double factor,
                            cv::Size picture) {
  query::MotionGuide guide = query::guide_of_animation(request, labelled);
  if (factor == 1 || guide.empty()) return guide;
  guide = query::reduce(guide, factor);
  const auto fit = [&](cv::Mat& map) {
    if (!map.empty() && map.size() != picture) cv::resize(map, map, picture, 0, 0, cv::INTER_NEAREST);
  };
  fit(guide.direction);
  fit(guide.speed);
  return guide;
}

/// As `synth animate` takes the same words of project.toml.
synth::animate::Method method_of(const Document& document) {
  namespace animate = synth::animate;
  animate::Method method;
  for (const auto& [name, value] : method_settings_of(document))
    animate::method_setting(name).set(method, value);
  if (auto* const forms = std::get_if<animate::FormsOptions>(&method)) {
    forms->excluded = document.excluded_clips;
    forms->placed_only = !document.pins.empty();
  }
  return method;
}

}  // namespace

FrameReel::FrameReel(std::uint64_t reel_number, std::string reel_stage, cv::Size reel_size, int frames,
                     double rate, int first_frame)
    : number(reel_number),
      stage(std::move(reel_stage)),
      size(reel_size),
      total(frames),
      fps(rate),
      first(first_frame) {}

void FrameReel::add(const cv::Mat& frame) {
  std::string bytes = encoded(frame);
  const std::lock_guard lock(guard_);
  frames_.push_back(std::move(bytes));
}

int FrameReel::ready() const {
  const std::lock_guard lock(guard_);
  return static_cast<int>(frames_.size());
}

std::optional<std::string> FrameReel::frame(int index) const {
  const std::lock_guard lock(guard_);
  if (index < 0 || static_cast<std::size_t>(index) >= frames_.size()) return std::nullopt;
  return frames_[static_cast<std::size_t>(index)];
}

void FrameReel::add_outline(const cv::Mat& matte) {
  constexpr double kTidy = 0.7;  // px that a line may leave its pixels by
  std::vector<std::vector<cv::Point>> lines;
  cv::findContours(matte >= 0.5, lines, cv::RETR_LIST, cv::CHAIN_APPROX_SIMPLE);
  for (std::vector<cv::Point>& line : lines) cv::approxPolyDP(line, line, kTidy, true);
  std::erase_if(lines, [](const std::vector<cv::Point>& line) { return line.size() < 3; });
  const std::lock_guard lock(guard_);
  outlines_.push_back(std::move(lines));
}

std::string FrameReel::outlines_json() const {
  std::vector<std::vector<std::vector<cv::Point>>> known;
  {
    const std::lock_guard lock(guard_);
    known = outlines_;
  }
  nlohmann::json json = nlohmann::json::array();
  for (const std::vector<std::vector<cv::Point>>& lines : known) {
    nlohmann::json& frame = json.emplace_back(nlohmann::json::array());
    for (const std::vector<cv::Point>& line : lines) {
      nlohmann::json& points = frame.emplace_back(nlohmann::json::array());
      for (const cv::Point& point : line) {
        points.push_back(point.x);
        points.push_back(point.y);
      }
    }
  }
  return json.dump();
}

Rendering rendering_of(const LabelledPicture& labelled, const Document& document, const ReelScene& scene,
                       int frames, double fps) {
  namespace animate = synth::animate;
  const cv::Size size = scene.picture.size();
  Rendering made{
      .assignment = labelled.labelling.assignment,
      .asked = guide_of(labelled.request, labelled.labelling.assignment.picture, scene.factor, size),
      .playing = {.factor = document.speed != 0 ? document.speed : own_pace(labelled), .map = scene.tempo},
      .options = {}};
  made.assignment.picture = size;
  made.assignment.piece_scale /= scene.factor;
  animate::AnimateOptions& options = made.options;
  options.frames = frames;
  options.fps = fps;
  options.loop = document.loop && frames > 1;
  options.memory_bytes = kMemory;
  options.method = method_of(document);
  if (!document.flames.empty()) options.for_fires.reset();
  if (auto* const carried = std::get_if<animate::CarriedOptions>(&options.method);
      carried != nullptr && scene.motion_alone)
    carried->innovations.reset();
  options.tiles = labelled.store->tiles;
  if (document.moving_outline) options.outline.kind = synth::outline::Outline::kMoving;
  options.outline.held = scene.held;
  return made;
}

void render(const LabelledPicture& labelled, const Document& document, const ReelScene& scene,
            FrameReel& reel, const std::function<void()>& told, const Job& job) {
  namespace animate = synth::animate;
  Rendering made = rendering_of(labelled, document, scene, reel.total, reel.fps);
  if (document.moving_outline)
    made.options.matte_sink = [&](const cv::Mat& matte) { reel.add_outline(matte); };
  const animate::Staging staging =
      animate::stage(labelled.store->snapshot, made.assignment, scene.picture.size(), made.asked,
                     made.playing, made.options);
  animate::animate(
      labelled.store->snapshot, labelled.store->base.settings, scene.picture, scene.matte, staging.placement,
      staging.options,
      [&](const cv::Mat& frame) {
        reel.add(frame);
        told();
      },
      job.progress, job.stop);
}

cv::Mat assigned_motion(const LabelledPicture& labelled, cv::Size picture) {
  namespace animate = synth::animate;
  const animate::Placement placement =
      animate::stage(labelled.store->snapshot, labelled.labelling.assignment, picture, {}, {}, {}).placement;
  return animate::motion_field(labelled.store->snapshot, labelled.store->base.settings, placement, picture);
}

}  // namespace freshet::studio
