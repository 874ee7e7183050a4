#include "synth/flowlines/flowlines.h"

#include <algorithm>
#include <array>
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
constexpr float kMinFade = 1.5f;                            // frames
constexpr double kCameraPx = 0.35;                          // px a frame of what stands still
constexpr double kAllCut = 0.95;                            // share of places too slow to be ridden
constexpr double kMaxAlike = 0.25;                          // of the picture
constexpr double kMinStill = 0.02;                          // of the picture, for the camera to be judged by
constexpr std::array<double, 4> kWays{0.5, 0.4, 0.3, 0.2};  // shares of the frames for particles' ways
constexpr double kAgainst = 0.5;  // share of a drawn line that may run against the flow

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
    report.ride_s = watch.seconds();
    watch = Stopwatch();
    plan(job);
    report.plan_s = watch.lap();
    if (!options.edited.empty()) edit();
    report.edit_s = watch.seconds();
  }

  double patch() const { return report.patch_px * scale; }  // px of the working picture
  double spacing() const { return report.spacing_px * scale; }

  StrandOptions strands() const {
    const double width = options.strand_px < 0 ? 3 * report.patch_px : options.strand_px;
    return {.spacing_px = spacing(), .width_px = width * scale, .blend_px = std::max(2.0, patch() / 2)};
  }

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
      // Local contrast is evened out: flow sees little of a fall at dusk, and half of what it sees too slow.
      cv::cvtColor(working[i], luma[i], cv::COLOR_BGR2GRAY);
      cv::createCLAHE(3.0, cv::Size(8, 8))->apply(luma[i], luma[i]);
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
    if (motion.still_share < kMinStill && motion.alike_share > kMaxAlike &&
        motion.alike_px / scale > kCameraPx)
      throw Error(ErrorKind::kInput, footage.name,
                  fmt::format("the camera moves: nothing stands still, and {:.0f} % of the picture goes "
                              "{:.1f} px a frame alike",
                              100 * motion.alike_share, motion.alike_px / scale),
                  "Steady the clip first; or go on regardless with --moving-camera, where it is a sky that "
                  "drifts as one");
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

  /// K and the particles' way share the clip's frames: some divisions are tried, and the cheapest is taken.
  void plan(const Job& job) {
    const int margin = std::clamp(footage.count() / 10, 2, 8);
    const int room = footage.count() - 2 * margin;
    if (options.entries > room - 2)
      throw Error(
          ErrorKind::kUsage, fmt::format("--entries {}", options.entries),
          fmt::format("of the clip's {} frames at most {} can be repeated", footage.count(), room - 2),
          "Ask for fewer, or give a longer clip");
    const Ladders ladders(working);
    std::vector<int> ways{room - options.entries};
    if (options.entries == 0) {
      ways.clear();
      for (const double share : kWays) ways.push_back(cvRound(share * room));
    }
    std::vector<Ladder> best;
    double least = 0;
    for (std::size_t w = 0; w < ways.size(); ++w) {
      if (job.stop.stop_requested()) throw Error(ErrorKind::kCancelled, "repeats", "stopped");
      if (job.progress) job.progress({"planning repeats", w, ways.size()});
      const float floor = floor_for(working_lines, rides, strands(), static_cast<float>(ways[w]));
      Arrivals tried = arrivals(working_lines, rides, luma.front().size(), strands(), floor, false);
      double price = 0;
      std::vector<Ladder> made = ladders_of(ladders, tried, margin, share_below(rides, floor), price);
      if (!best.empty() && price >= least) continue;
      least = price;
      best = std::move(made);
      arrived = std::move(tried);
      working_floor = floor;
    }
    if (!rides.stationary)
      arrived = arrivals(working_lines, rides, luma.front().size(), strands(), working_floor, true);
    report.floor_px = static_cast<double>(working_floor) / scale;
    report.cut_share = share_below(rides, working_floor);
    if (report.cut_share > kAllCut)
      report.notices.push_back(
          fmt::format("hardly anything rides to its end: particles would take longer than the {} frames, and "
                      "runs fade into each "
                      "other in place. Give more frames of it; what flickers in its place, such as a candle, "
                      "is no case for flow lines",
                      footage.count()));
    report.streams = static_cast<int>(arrived.streams.size());
    report.entries = best.front().entries();
    report.way = static_cast<double>(arrived.streams.front().duration);
    report.jump_cost = best.front().jump;
    moments.emplace(arrived, fade_of(margin), orders_of(best, margin), footage.count());
    renderer.emplace(footage.frames, luma.front().size(), options.render);
  }

  /// All streams' ladders; price: what their discontinuities weigh together, by area.
  std::vector<Ladder> ladders_of(const Ladders& ladders, const Arrivals& tried, int margin, double cut,
                                 double& price) const {
    float longest = 0;
    for (const Stream& stream : tried.streams) longest = std::max(longest, stream.duration);
    const int entries = options.entries > 0
                            ? options.entries
                            : footage.count() - 2 * margin - static_cast<int>(std::ceil(longest));
    std::vector<Ladder> made;
    for (std::size_t k = 0; k < tried.streams.size(); ++k) {
      const cv::Mat where = tried.stream == static_cast<double>(k);
      made.push_back(ladders.of(tried.streams[k], where, margin, entries, repeats_of(k)));
      // Particles that a rung cuts are discontinuities too; and a rung that is through soon is seen all at once.
      const double together = made[k].jump / (static_cast<double>(tried.streams[k].duration) + 2 * margin);
      price += cv::countNonZero(where) * (made[k].per_frame * (1 + cut) + 0.5 * together);
    }
    return made;
  }

  RepeatOptions repeats_of(std::size_t stream) const { return {.seed = options.seed * 1000 + stream}; }

  std::vector<Order> orders_of(const std::vector<Ladder>& ladders, int margin) const {
    std::vector<Order> orders;
    for (std::size_t k = 0; k < ladders.size(); ++k) {
      RepeatOptions repeats = repeats_of(k);
      repeats.min_run = ladders[k].min_run;
      if (options.loop_frames == 0) {
        orders.emplace_back(ladders[k], repeats,
                            static_cast<int>(arrived.streams[k].duration) + 2 * margin + 4);
        continue;
      }
      std::vector<Run> period = cyclic(ladders[k].cost, options.loop_frames, repeats);
      if (period.empty())
        throw Error(ErrorKind::kUsage, fmt::format("--loop --frames {}", options.loop_frames),
                    "no order of repeats is that short",
                    fmt::format("Ask for {} frames or more", 2 * ladders[k].min_run + 2));
      orders.emplace_back(ladders[k], std::move(period), options.loop_frames);
    }
    return orders;
  }

  /// Edited lines take their textures from the input lines, and the clip from what those leave.
  void edit() {
    const EditOptions edits{.correspondence = options.view.correspondence,
                            .patch_px = report.patch_px,
                            .spacing_px = report.spacing_px,
                            .join_px = options.join_px};
    const std::vector<int> partner = partners(lines, options.edited, options.edited_name);
    std::vector<bool> used(lines.size(), false);
    for (const int input : partner) used[static_cast<std::size_t>(input)] = true;
    const std::vector<FlowLine> inputs = dense_inputs(lines, edits);
    edited = densify(inputs, options.edited, partner, footage.frames, edits);
    report.drawn = static_cast<int>(options.edited.size());
    report.interpolated = static_cast<int>(edited.size()) - report.drawn;
    if (const auto without = std::count(used.begin(), used.end(), false); without > 0)
      report.notices.push_back(fmt::format(
          "{} of {} input lines have no edited one: their fluid is taken away", without, lines.size()));
    EditedViewOptions view_options = options.view;
    view_options.patch_px = report.patch_px;
    view_options.render = options.render;
    view.emplace(footage.frames, luma.front().size(), inputs, edited, matte, renderer->mean(), view_options);
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
  float working_floor = 0;  // px of the working picture a frame
  std::optional<Moments> moments;
  std::optional<Renderer> renderer;
  std::vector<EditedLine> edited;
  std::optional<EditedView> view;
  std::vector<Moment> moment;
  cv::Mat out;
  std::int64_t frame = 0;
};

Flowlines::Flowlines(const Footage& footage, const FlowlinesOptions& options, const Job& job)
    : impl_(std::make_unique<Impl>(footage, options, job)) {}
Flowlines::~Flowlines() = default;

const FlowlinesReport& Flowlines::report() const { return impl_->report; }
const std::vector<FlowLine>& Flowlines::lines() const { return impl_->lines; }
const std::vector<EditedLine>& Flowlines::edited() const { return impl_->edited; }
const cv::Mat& Flowlines::matte() const { return impl_->matte; }

cv::Mat Flowlines::fluid() const {
  if (impl_->view) return impl_->view->alpha();
  cv::Mat soft;
  cv::GaussianBlur(impl_->matte, soft, cv::Size(), std::max(1.0, impl_->report.patch_px / 12));
  soft.convertTo(soft, CV_32F, 1.0 / 255);
  return soft;
}

const cv::Mat& Flowlines::next() {
  impl_->moments->at(impl_->frame++, impl_->moment);
  impl_->renderer->render(impl_->moment, impl_->out);
  if (impl_->view) impl_->view->render(impl_->moment, impl_->out);
  return impl_->out;
}

}  // namespace freshet::synth::flowlines
