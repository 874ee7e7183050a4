#include "synth/flowlines/flowlines.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/flowlines/arrival.h"
#include "synth/flowlines/moments.h"
#include "synth/flowlines/streamlines.h"

namespace freshet::synth::flowlines {
namespace {

constexpr int kWorkingSide = 480;  // px: longer pictures are looked at reduced
constexpr int kMinFrames = 16;
constexpr float kMinFade = 1.5f;    // frames
constexpr double kCameraPx = 0.35;  // px a frame of what stands still
constexpr double kMinStill = 0.02;  // of the picture, for the camera to be judged by
constexpr double kAgainst = 0.5;    // share of a drawn line that may run against the flow

double working_scale(cv::Size size) {
  return std::min(1.0, static_cast<double>(kWorkingSide) / std::max(size.width, size.height));
}

}  // namespace

double default_patch(cv::Size picture) {
  return 24.0 * std::max(1.0, std::max(picture.width, picture.height) / 320.0);
}

struct Flowlines::Impl {
  Impl(const Footage& clip, const FlowlinesOptions& asked, const Job& job)
      : footage(clip), options(asked), scale(working_scale(clip.size())) {
    check();
    reduce();
    Stopwatch watch;
    motion = measure_motion(luma, {}, job);
    judge_camera();
    find_matte();
    report.motion_s = watch.seconds();
    find_lines();
    watch = Stopwatch();
    rides = follow(luma, working_lines, motion, {.dynamics = options.dynamics, .patch_px = patch()}, job);
    judge_lines();
    arrived = arrivals(working_lines, rides, luma.front().size(), spacing());
    report.ride_s = watch.seconds();
    watch = Stopwatch();
    plan(job);
    report.plan_s = watch.seconds();
  }

  double patch() const { return report.patch_px * scale; }  // px of the working picture
  double spacing() const { return report.spacing_px * scale; }

  void check() {
    if (footage.count() < kMinFrames)
      throw Error(ErrorKind::kInput, footage.name,
                  fmt::format("it has {} frames, at least {} are needed", footage.count(), kMinFrames),
                  "Give a longer clip: two seconds are good");
    report.patch_px = options.patch_px > 0 ? options.patch_px : default_patch(footage.size());
    report.spacing_px = options.spacing_px > 0 ? options.spacing_px : report.patch_px / 2;
  }

  void reduce() {
    const cv::Size size(std::max(16, cvRound(footage.size().width * scale)),
                        std::max(16, cvRound(footage.size().height * scale)));
    working.resize(footage.frames.size());
    luma.resize(footage.frames.size());
    tbb::parallel_for(std::size_t{0}, working.size(), [&](std::size_t i) {
      if (size == footage.size())
        working[i] = footage.frames[i];
      else
        cv::resize(footage.frames[i], working[i], size, 0, 0, cv::INTER_AREA);
      cv::cvtColor(working[i], luma[i], cv::COLOR_BGR2GRAY);
    });
  }

  void judge_camera() {
    if (options.moving_camera) return;
    if (motion.still_share >= kMinStill && motion.camera_px / scale > kCameraPx)
      throw Error(ErrorKind::kInput, footage.name,
                  fmt::format("the camera moves: what does not flow goes {:.1f} px a frame, up to {:.1f}",
                              motion.camera_px / scale, motion.camera_max_px / scale),
                  "Steady the clip first, choose a part in which the camera stands still with --from and "
                  "--input-frames, or go on regardless with --moving-camera");
    if (motion.still_share < kMinStill)
      report.notices.push_back(
          "nothing in the picture stands still: if that is the camera's motion, steady the clip first");
  }

  void find_matte() {
    if (!options.matte.empty()) {
      cv::resize(options.matte, working_matte, luma.front().size(), 0, 0, cv::INTER_AREA);
    } else {
      working_matte = motion.matte;
    }
    cv::resize(working_matte, matte, footage.size(), 0, 0, cv::INTER_LINEAR);
  }

  void find_lines() {
    if (!options.lines.empty()) {
      lines = options.lines;
      for (const FlowLine& line : lines) working_lines.push_back(scaled(line, static_cast<float>(scale)));
    } else {
      const cv::Mat field = smoothed(motion.mean, working_matte, std::max(2.0, patch() / 4));
      working_lines =
          evenly_spaced(field, working_matte, {.spacing_px = spacing(), .min_length_px = patch()});
      for (const FlowLine& line : working_lines) lines.push_back(scaled(line, static_cast<float>(1 / scale)));
    }
    report.lines = static_cast<int>(lines.size());
    if (lines.empty())
      throw Error(
          ErrorKind::kInput, footage.name,
          fmt::format("nothing in it flows along lines: {:.1f} % of the picture moves one way for long",
                      100.0 * cv::countNonZero(working_matte) / static_cast<double>(working_matte.total())),
          "Draw the lines with --lines, say where the fluid is with --matte, or lower --patch where the "
          "fluid is small; what flickers or sways in its place, such as a candle, is no case for flow lines");
  }

  void judge_lines() {
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (!options.lines.empty() && rides.lines[i].against > kAgainst)
        throw Error(
            ErrorKind::kInput, lines[i].name,
            fmt::format("the clip flows against this line over {:.0f} % of it", 100 * rides.lines[i].against),
            "Draw it the other way round, from where the fluid enters to where it leaves");
    report.stationary = rides.stationary;
    report.gain = rides.gain;
  }

  /// Half a patch's way in frames, within what the clip has room for.
  cv::Mat fade_of(int margin) const {
    cv::Mat fade;
    cv::divide(0.5 * patch(), arrived.speed, fade);
    return cv::max(cv::min(fade, static_cast<float>(margin)), kMinFade);
  }

  void plan(const Job& job) {
    LadderOptions ladder_options{.margin = std::clamp(footage.count() / 10, 2, 8),
                                 .entries = options.entries};
    const cv::Mat fade = fade_of(ladder_options.margin);
    std::vector<Order> orders;
    for (std::size_t k = 0; k < arrived.streams.size(); ++k) {
      if (job.progress) job.progress({"planning repeats", k, arrived.streams.size()});
      Stream& stream = arrived.streams[k];
      RepeatOptions repeats{.seed = options.seed * 1000 + k};
      ladder_options.repeats = repeats;
      const Ladder ladder = plan_ladder(working, stream, arrived.stream == static_cast<double>(k),
                                        footage.name, ladder_options, job);
      if (k == 0) {
        report.entries = ladder.entries();
        report.way = static_cast<double>(stream.duration);
        report.hastened = ladder.hastened;
        report.jump_cost = ladder.per_frame;
      }
      hasten(stream, static_cast<float>(ladder.hastened));
      repeats.min_run = ladder.min_run;
      if (options.loop_frames == 0) {
        orders.emplace_back(ladder, repeats,
                            static_cast<int>(stream.duration) + 2 * ladder_options.margin + 4);
        continue;
      }
      std::vector<Run> period = cyclic(ladder.cost, options.loop_frames, repeats);
      if (period.empty())
        throw Error(ErrorKind::kUsage, fmt::format("--frames {} --loop", options.loop_frames),
                    "no order of repeats is that long",
                    fmt::format("A loop of this clip has at least {} frames", 2 * ladder.min_run + 2));
      orders.emplace_back(ladder, std::move(period), options.loop_frames);
    }
    report.streams = static_cast<int>(arrived.streams.size());
    moments.emplace(arrived, fade, std::move(orders), footage.count());
    renderer.emplace(footage.frames, luma.front().size(), options.render);
  }

  const Footage& footage;
  FlowlinesOptions options;
  double scale;
  FlowlinesReport report;
  std::vector<cv::Mat> working, luma;
  ClipMotion motion;
  cv::Mat working_matte, matte;
  std::vector<FlowLine> lines, working_lines;
  Rides rides;
  Arrivals arrived;
  std::optional<Moments> moments;
  std::optional<Renderer> renderer;
  std::vector<Moment> moment;
  cv::Mat out;
  std::int64_t frame = 0;
};

Flowlines::Flowlines(const Footage& footage, const FlowlinesOptions& options, const Job& job)
    : impl_(std::make_unique<Impl>(footage, options, job)) {}
Flowlines::~Flowlines() = default;

const FlowlinesReport& Flowlines::report() const { return impl_->report; }
const std::vector<FlowLine>& Flowlines::lines() const { return impl_->lines; }
const cv::Mat& Flowlines::matte() const { return impl_->matte; }

const cv::Mat& Flowlines::next() {
  impl_->moments->at(impl_->frame++, impl_->moment);
  impl_->renderer->render(impl_->moment, impl_->out);
  return impl_->out;
}

}  // namespace freshet::synth::flowlines
