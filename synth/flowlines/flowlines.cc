#include "synth/flowlines/flowlines.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "synth/flowlines/lines/moving_lines.h"
#include "synth/flowlines/moments.h"
#include "synth/flowlines/plan.h"
#include "synth/flowlines/streamlines.h"
#include "synth/flowlines/working_clip.h"

namespace freshet::synth::flowlines {
namespace {

constexpr float kMinFade = 1.5f;  // frames
constexpr double kDetail = 8;     // of a patch: twice that is the side of what fine detail is finer than
constexpr double kLively = 0.5;   // of how much what flows changes
constexpr double kAllCut = 0.95;  // share of places too slow to be ridden
constexpr double kAgainst = 0.5;  // share of a drawn line that may run against the flow

}  // namespace

double default_patch(cv::Size picture) {
  return 24.0 * std::max(1.0, std::max(picture.width, picture.height) / 320.0);
}

struct Flowlines::Impl {
  Impl(const Footage& clip, const FlowlinesOptions& asked, const Job& job) : footage(clip), options(asked) {
    Stopwatch watch;
    // Positions and names first: a slip in them should not cost the preparation.
    moving.emplace(options.edited, options.loop_frames / output_fps(), options.edited_name);
    if (!options.lines.empty()) partners(options.lines, moving->at(0), options.edited_name);
    working = working_clip(footage, job);
    if (!options.moving_camera) judge_camera(working, footage.name, report.notices);
    report.patch_px = options.patch_px > 0 ? options.patch_px : default_patch(footage.size());
    report.spacing_px = options.spacing_px > 0 ? options.spacing_px : report.patch_px / 2;
    find_matte();
    report.motion_s = watch.seconds();
    find_lines();
    watch = Stopwatch();
    rides = follow(working.luma, working_lines, working.motion,
                   {.dynamics = options.dynamics, .patch_px = patch()}, job);
    judge_lines();
    report.ride_s = watch.seconds();
    watch = Stopwatch();
    plan_moments(job);
    report.plan_s = watch.lap();
    if (!options.edited.empty()) edit();
    report.edit_s = watch.seconds();
  }

  double patch() const { return report.patch_px * working.scale; }  // px of the working picture
  double spacing() const { return report.spacing_px * working.scale; }

  void find_matte() {
    if (!options.matte.empty()) {
      cv::resize(options.matte, working_matte, working.size(), 0, 0, cv::INTER_AREA);
    } else {
      working_matte = working.motion.matte;
      if (!options.lines.empty()) working_matte |= lively_beside(options.lines);
    }
    cv::resize(working_matte, matte, footage.size(), 0, 0, cv::INTER_LINEAR);
  }

  /// Where a person draws a line there is fluid, though foam that seethes in its place does not flow: what changes
  /// there for a good part as much as what flows.
  cv::Mat lively_beside(const std::vector<FlowLine>& drawn) const {
    cv::Mat change(working.size(), CV_32F, cv::Scalar(0)), difference,
        away(working.size(), CV_8U, cv::Scalar(255));
    for (std::size_t t = 1; t < working.luma.size(); ++t) {
      cv::absdiff(working.luma[t], working.luma[t - 1], difference);
      cv::accumulate(difference, change);
    }
    cv::GaussianBlur(change, change, cv::Size(), std::max(1.0, patch() / 6));
    for (const FlowLine& line : drawn)
      for (const cv::Point2f& point : scaled(line, static_cast<float>(working.scale)).points)
        away.at<std::uint8_t>(std::clamp(cvRound(point.y), 0, away.rows - 1),
                              std::clamp(cvRound(point.x), 0, away.cols - 1)) = 0;
    cv::distanceTransform(away, difference, cv::DIST_L2, cv::DIST_MASK_5);
    const double flowing = cv::mean(change, working.motion.matte)[0];
    // White foam hardly changes, but lies among what does.
    const int side = 2 * cvRound(patch() / 3) + 1;
    const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(side, side));
    cv::Mat lively = (change > kLively * flowing) | working.motion.matte;
    cv::morphologyEx(lively, lively, cv::MORPH_CLOSE, disc);
    return lively & (difference < patch() / 2);
  }

  void find_lines() {
    if (!options.lines.empty()) {
      lines = options.lines;
      for (const FlowLine& line : lines)
        if (line.time_s)
          throw Error(
              ErrorKind::kInput, line.name, "an input line has a data-time",
              "Input lines lie where the clip's fluid is; give positions in time to the edited lines");
      for (const FlowLine& line : lines)
        working_lines.push_back(scaled(line, static_cast<float>(working.scale)));
    } else {
      const cv::Mat field = smoothed(working.motion.mean, working_matte, std::max(2.0, patch() / 4));
      working_lines =
          evenly_spaced(field, working_matte, {.spacing_px = spacing(), .min_length_px = patch()});
      for (const FlowLine& line : working_lines)
        lines.push_back(scaled(line, static_cast<float>(1 / working.scale)));
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
  cv::Mat fade() const {
    cv::Mat frames;
    cv::divide(0.5 * patch(), plan.arrivals.speed, frames);
    return cv::max(cv::min(frames, static_cast<float>(plan.margin)), kMinFade);
  }

  StrandOptions strands() const {
    const double width = options.strand_px < 0 ? 3 * report.patch_px : options.strand_px;
    return {
        .spacing_px = spacing(), .width_px = width * working.scale, .blend_px = std::max(2.0, patch() / 2)};
  }

  PlanOptions plan_options() const {
    return {.strands = strands(),
            .entries = options.entries,
            .loop_frames = options.loop_frames,
            .in_turn = options.in_turn,
            .seed = options.seed};
  }

  /// What places show in one more time.
  void add_time() {
    const bool cuts = options.mixing == Mixing::kCut;
    times.emplace_back(
        plan.arrivals, fade(), orders_of(plan, plan_options(), static_cast<int>(times.size())),
        footage.count(),
        CutOptions{
            .frames = cuts ? &ladders->frames() : nullptr, .whole = &working.frames, .margin = plan.margin});
    moments.emplace_back();
  }

  void plan_moments(const Job& job) {
    ladders.emplace(working.frames);
    plan = plan_repeats(*ladders, working_lines, rides, working.size(), footage.count(), plan_options(), job);
    report.floor_px = static_cast<double>(plan.floor) / working.scale;
    report.cut_share = plan.cut_share;
    if (plan.cut_share > kAllCut)
      report.notices.push_back(
          fmt::format("hardly anything rides to its end: particles would take longer than the {} frames, and "
                      "runs go over into each other in place. Give more frames of it; what flickers in its "
                      "place, such as a candle, is no case for flow lines",
                      footage.count()));
    report.streams = static_cast<int>(plan.arrivals.streams.size());
    report.entries = plan.ladders.front().entries();
    report.way = static_cast<double>(plan.arrivals.streams.front().duration);
    report.jump_cost = plan.ladders.front().jump;
    add_time();
    render = {.mixing = options.mixing,
              .likeness = likeness(),
              .detail_px = 2 * std::max(1, cvRound(report.patch_px / kDetail)) + 1};
    renderer.emplace(footage.frames, working.size(), render);
  }

  cv::Mat likeness() const {
    cv::Mat by_pixel;
    cv::resize(likeness_of(working.frames, patch()), by_pixel, footage.size());
    return by_pixel;
  }

  cv::Mat soft_matte() const {
    cv::Mat soft;
    cv::GaussianBlur(matte, soft, cv::Size(), std::max(1.0, report.patch_px / 12));
    soft.convertTo(soft, CV_32F, 1.0 / 255);
    return soft;
  }

  /// Edited lines take their textures from the input lines, and the clip from what those leave.
  void edit() {
    const EditOptions edits{.correspondence = options.view.correspondence,
                            .patch_px = report.patch_px,
                            .spacing_px = report.spacing_px,
                            .join_px = options.join_px};
    const std::vector<FlowLine> drawn = moving->at(0);
    const std::vector<int> partner = partners(lines, drawn, options.edited_name);
    std::vector<bool> used(lines.size(), false);
    for (const int input : partner) used[static_cast<std::size_t>(input)] = true;
    const std::vector<FlowLine> inputs = dense_inputs(lines, edits);
    edited = densify(inputs, drawn, partner, footage.frames, edits);
    for (const EditedLine& line : edited)
      while (line.time >= static_cast<int>(times.size())) add_time();
    report.drawn = static_cast<int>(drawn.size());
    report.interpolated = static_cast<int>(edited.size()) - report.drawn;
    if (const auto without = std::count(used.begin(), used.end(), false); without > 0)
      report.notices.push_back(fmt::format(
          "{} of {} input lines have no edited one: their fluid is taken away", without, lines.size()));
    EditedViewOptions view_options = options.view;
    view_options.patch_px = report.patch_px;
    view_options.render = render;
    view.emplace(footage.frames, working.size(), inputs, matte, renderer->mean(), view_options);
    view->lead(edited);
  }

  double output_fps() const { return options.fps > 0 ? options.fps : footage.fps; }

  /// Lines of a frame of the output lie where their positions say.
  void move_lines() {
    if (!view || !moving->moves()) return;
    follow_drawn(moving->at(static_cast<double>(frame) / output_fps()), edited);
    view->lead(edited);
  }

  const Footage& footage;
  FlowlinesOptions options;
  FlowlinesReport report;
  WorkingClip working;
  cv::Mat working_matte, matte;
  std::vector<FlowLine> lines, working_lines;
  Rides rides;
  std::optional<Ladders> ladders;
  Plan plan;
  std::vector<Moments> times;  // of the clip, and of copies of its lines
  RenderOptions render;
  std::optional<Renderer> renderer;
  std::optional<MovingLines> moving;
  std::vector<EditedLine> edited;
  std::optional<EditedView> view;
  std::vector<std::vector<Moment>> moments;  // of the frame, by time
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
  return impl_->soft_matte();
}

const cv::Mat& Flowlines::next() {
  impl_->move_lines();
  for (std::size_t i = 0; i < impl_->times.size(); ++i) impl_->times[i].at(impl_->frame, impl_->moments[i]);
  ++impl_->frame;
  impl_->renderer->render(impl_->moments.front(), impl_->out);
  if (impl_->view) impl_->view->render(impl_->moments, impl_->out);
  return impl_->out;
}

}  // namespace freshet::synth::flowlines
