#include "studio/frame_reel.h"

#include <utility>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "query/search/picture_scale.h"
#include "studio/clip_strip.h"
#include "synth/animate/animate.h"
#include "synth/animate/motion/motion_field.h"
#include "synth/animate/staging.h"

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

}  // namespace

FrameReel::FrameReel(std::uint64_t reel_number, std::string reel_stage, cv::Size reel_size, int frames,
                     double rate)
    : number(reel_number), stage(std::move(reel_stage)), size(reel_size), total(frames), fps(rate) {}

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

void render(const LabelledPicture& labelled, const Document& document, const Scene& scene, FrameReel& reel,
            const std::function<void()>& told, const Job& job) {
  namespace animate = synth::animate;
  animate::AnimateOptions options;
  options.frames = reel.total;
  options.fps = reel.fps;
  options.loop = document.loop && reel.total > 1;
  options.memory_bytes = kMemory;
  if (scene.motion_alone) options.method = animate::CarriedOptions{.innovations = std::nullopt};
  options.tiles = labelled.store->tiles;
  if (document.moving_outline) {
    options.outline.kind = synth::outline::Outline::kMoving;
    options.matte_sink = [&](const cv::Mat& matte) { reel.add_outline(matte); };
  }
  options.outline.held = scene.held;
  query::Assignment assignment = labelled.labelling.assignment;
  const cv::Size labelled_size = assignment.picture;
  const cv::Size size = scene.picture.size();
  assignment.picture = size;
  assignment.piece_scale /= scene.factor;
  const animate::Staging staging =
      animate::stage(labelled.store->snapshot, assignment, size,
                     guide_of(labelled.request, labelled_size, scene.factor, size),
                     {.factor = document.speed, .map = scene.tempo}, options);
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
