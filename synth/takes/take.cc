#include "synth/takes/take.h"

#include <algorithm>

namespace freshet::synth::takes {
namespace {

constexpr double kSlower = 0.5, kFaster = 2, kShorter = 0.5, kLonger = 2;

}  // namespace

std::vector<Take> plan_takes(const std::string& kind, const animate::AnimateOptions& options,
                             const query::MotionGuide& asked, const Open& open, int count) {
  std::vector<Take> takes{{.name = "as asked", .options = ""}};
  const auto* const carried = std::get_if<animate::CarriedOptions>(&options.method);
  if (carried == nullptr) return takes;
  const auto add = [&](bool may, Take take) {
    if (may && static_cast<int>(takes.size()) < std::min(count, kMaxTakes)) takes.push_back(std::move(take));
  };
  const bool water = kind == "water", fire = kind == "fire";
  const bool speeds = !asked.speed.empty();
  add(fire && open.method && !options.moving(),
      {.name = "flames of clips", .options = "--method forms", .forms = true});
  add(speeds,
      {.name = "at the clips' own speeds", .options = "strokes without data-speed", .own_speeds = true});
  add(open.speed, {.name = "half as fast", .options = "--speed 0.5", .speed = kSlower});
  add(water && open.layout && !options.moving() && carried->layout != animate::Layout::kStands,
      {.name = "over a layout that stands",
       .options = "--layout stands",
       .layout = animate::Layout::kStands});
  add(open.life, {.name = "detail lives half as long", .options = "--detail-life", .life = kShorter});
  add(open.speed, {.name = "twice as fast", .options = "--speed 2", .speed = kFaster});
  add(open.life, {.name = "detail lives twice as long", .options = "--detail-life", .life = kLonger});
  return takes;
}

void apply(const Take& take, double half_life_s, animate::AnimateOptions& options, query::MotionGuide& asked,
           animate::Playing& playing) {
  if (take.own_speeds) asked.speed.release();
  if (take.speed != 1) {
    if (!asked.speed.empty()) {
      // Not in place: the guide is a view of what all takes share. What is asked nowhere is negative, and stays so.
      cv::Mat scaled;
      asked.speed.convertTo(scaled, CV_32F, take.speed);
      asked.speed = scaled;
    } else {
      playing.factor = std::clamp(playing.factor * take.speed, 0.05, 20.0);
    }
  }
  if (take.forms) {
    animate::FormsOptions forms = options.for_fires.value_or(animate::FormsOptions{});
    forms.flames = animate::Flames::kClips;
    options.method = forms;
  }
  auto* const carried = std::get_if<animate::CarriedOptions>(&options.method);
  if (carried == nullptr) return;
  if (take.layout) carried->layout = *take.layout;
  if (take.life != 1 && half_life_s > 0) carried->half_life_s = take.life * half_life_s;
}

}  // namespace freshet::synth::takes
