#include "synth/animate/animate.h"

#include <memory>
#include <utility>

#include "platform/stopwatch.h"
#include "synth/animate/frames/frame_batches.h"
#include "synth/animate/frames/still_part.h"

namespace freshet::synth::animate {
namespace {

std::unique_ptr<Renderer> renderer_of(Animation& animation, const StillPart& still,
                                      const AnimateOptions& options) {
  const auto* const carried = std::get_if<CarriedOptions>(&options.method);
  if (options.for_fires && carried != nullptr && carried->layout != Layout::kStands && !options.moving()) {
    FormsOptions fires = *options.for_fires;
    fires.carried = *carried;
    if (std::unique_ptr<Renderer> renderer = fire_renderer(animation, still, fires)) return renderer;
  }
  return std::visit([&](const auto& method) { return make_renderer(animation, still, method); },
                    options.method);
}

}  // namespace

AnimateReport animate(const store::Snapshot& snapshot, const vision::Settings& settings,
                      const cv::Mat& picture, const cv::Mat& matte, const Placement& placement,
                      const AnimateOptions& options, const std::function<void(const cv::Mat&)>& sink,
                      const ProgressFunction& progress, std::stop_token stop) {
  check(placement);
  const Stopwatch total;
  Animation animation{.snapshot = snapshot,
                      .settings = settings,
                      .picture = picture,
                      .matte = matte,
                      .placement = placement,
                      .options = options,
                      .progress = progress,
                      .stop = std::move(stop)};
  animation.report.pieces = placement.patches.size();
  StillPart still = read_still(animation);
  animation.report.base_s = animation.watch.lap();
  const std::unique_ptr<Renderer> renderer = renderer_of(animation, still, options);
  still.release_for_frames(options.moving());
  make_frames(animation, still, *renderer, sink);
  animation.report.total_s = total.seconds();
  return animation.report;
}

}  // namespace freshet::synth::animate
