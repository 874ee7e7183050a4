#include "synth/animate/frames/frame_batches.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include "synth/animate/frames/handover.h"

namespace freshet::synth::animate {
namespace {

// Frames rendered at once before they are handed on in order: as many more are on their way out. Of large ones no more
// than there are threads.
constexpr int kMaxGroup = 8, kMinGroup = 4;
constexpr int kLarge_px = 4 << 20;

std::size_t group_of(cv::Size picture) {
  const int threads = oneapi::tbb::this_task_arena::max_concurrency();
  return static_cast<std::size_t>(picture.area() < kLarge_px ? kMaxGroup
                                                             : std::clamp(threads, kMinGroup, kMaxGroup));
}

/// Output frames in the order in which they are shown.
std::vector<int> order_of(const FrameOptions& options, int first) {
  std::vector<int> order(options.frames);
  std::iota(order.begin(), order.end(), 0);
  std::rotate(order.begin(), order.begin() + first, order.end());
  return order;
}

/// 0 beside the matte.
std::vector<cv::Mat> steps_of(const Renderer& renderer, std::span<const int> outputs,
                              std::span<const cv::Mat> mattes) {
  std::vector<cv::Mat> steps(outputs.size());
  oneapi::tbb::parallel_for(std::size_t{0}, steps.size(), [&](std::size_t i) {
    steps[i] = renderer.step(outputs[i]);
    steps[i].setTo(cv::Scalar::all(0), mattes[i] <= 0);
  });
  return steps;
}

}  // namespace

void make_frames(Animation& animation, const StillPart& still, Renderer& renderer,
                 const std::function<void(const cv::Mat&)>& sink) {
  const FrameOptions& options = animation.options;
  const std::vector<int> order = order_of(options, renderer.first());
  std::optional<outline::MatteSequence> moving_matte;
  if (options.moving())
    moving_matte.emplace(
        still.alpha, still.asked_motion, options.fps, options.outline.matte,
        [&](int i) { return renderer.motion(order[static_cast<std::size_t>(i) % order.size()]); },
        options.loop ? options.frames : 0, options.outline.held);
  Handover handover(sink);
  const std::size_t group = group_of(animation.picture.size());
  const int batch = renderer.batch(), end = options.end(), from = std::clamp(options.from, 0, end);
  animation.report.batches = (options.frames + batch - 1) / batch;
  for (int first = 0; first < end; first += batch) {
    const std::span<const int> read = std::span(order).subspan(first, std::min(batch, end - first));
    renderer.read(read);
    for (std::size_t done = 0; done < read.size(); done += group) {
      animation.throw_if_stopped();
      const std::span<const int> outputs = read.subspan(done, std::min(group, read.size() - done));
      const int before = first + static_cast<int>(done);
      const std::size_t passed =
          std::min(outputs.size(), static_cast<std::size_t>(std::max(0, from - before)));
      std::vector<cv::Mat> mattes(outputs.size(), still.alpha), finished(outputs.size() - passed);
      if (moving_matte)
        for (cv::Mat& matte : mattes) matte = moving_matte->next();
      if (options.matte_sink)
        for (std::size_t i = passed; i < mattes.size(); ++i) options.matte_sink(mattes[i]);
      renderer.prepare(outputs, mattes, passed);
      if (options.motion_sink)
        for (const cv::Mat& step :
             steps_of(renderer, outputs.subspan(passed), std::span(mattes).subspan(passed)))
          options.motion_sink(step);
      oneapi::tbb::parallel_for(std::size_t{0}, finished.size(), [&](std::size_t i) {
        finished[i] = renderer.finish(outputs[passed + i], mattes[passed + i]);
      });
      handover.take(std::move(finished));
      animation.tell("render", static_cast<std::size_t>(std::min(before + static_cast<int>(group), end)),
                     static_cast<std::size_t>(end));
    }
    animation.report.render_s += animation.watch.lap();
  }
  handover.wait();
  animation.report.render_s += animation.watch.lap();
}

}  // namespace freshet::synth::animate
