#include "synth/takes/trial.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "platform/stopwatch.h"
#include "query/search/picture_scale.h"

namespace freshet::synth::takes {
namespace {

/// The picture and all that is of its size, reduced.
class Small {
 public:
  Small(const Subject& subject, const TrialOptions& options) {
    const cv::Size whole = subject.picture.size();
    scale_ = std::max(1.0, static_cast<double>(std::max(whole.width, whole.height)) / options.side);
    picture = query::reduce(subject.picture, scale_);
    matte = query::reduce(subject.matte, scale_);
  }

  query::MotionGuide reduced(const query::MotionGuide& guide) const { return query::reduce(guide, scale_); }
  animate::Placement reduced(animate::Placement placement) const {
    placement.piece_scale /= scale_;
    return placement;
  }
  void reduce(animate::AnimateOptions& options, const TrialOptions& trial) const {
    options.matte_sink = options.motion_sink = {};
    options.form = animate::FrameForm::kWhole;
    options.from = 0;
    options.until = std::min(trial.frames, options.frames);
    if (!options.loop) options.frames = options.until;
    if (!options.outline.held.empty()) options.outline.held = query::reduce(options.outline.held, scale_);
    if (!options.outline.background.empty())
      options.outline.background = query::reduce(options.outline.background, scale_);
    if (auto* const carried = std::get_if<animate::CarriedOptions>(&options.method);
        carried != nullptr && !trial.with_innovations)
      carried->innovations.reset();
  }

  cv::Mat picture, matte;

 private:
  double scale_ = 1;
};

/// Makes one take; its report.
animate::AnimateReport make(const Subject& subject, const Small& small, const Take& take, double half_life_s,
                            const TrialOptions& trial, judging::Evidence& film, const std::stop_token& stop) {
  animate::AnimateOptions options = subject.options;
  query::MotionGuide asked = subject.asked;
  animate::Playing playing = subject.playing;
  apply(take, half_life_s, options, asked, playing);
  animate::Staging staging =
      animate::stage(subject.snapshot, subject.assignment, subject.picture.size(), asked, playing, options);
  staging.options.guide = small.reduced(staging.options.guide);
  small.reduce(staging.options, trial);
  return animate::animate(
      subject.snapshot, subject.settings, small.picture, small.matte, small.reduced(staging.placement),
      staging.options, [&](const cv::Mat& frame) { film.add(frame); }, {}, stop);
}

}  // namespace

Trial try_takes(const Subject& subject, const std::vector<Take>& takes, const TrialOptions& options,
                const std::function<void(std::size_t)>& progress, std::stop_token stop) {
  const Stopwatch watch;
  const Small small(subject, options);
  Trial trial;
  for (std::size_t i = 0; i < takes.size(); ++i) {
    if (progress) progress(i);
    JudgedTake judged{
        .take = takes[i],
        .film = judging::Evidence(small.picture, small.matte, subject.options.fps, options.side),
        .verdict = {},
        .failed = {}};
    try {
      const animate::AnimateReport report =
          make(subject, small, takes[i], trial.half_life_s, options, judged.film, stop);
      if (i == 0) trial.half_life_s = report.half_life_s;
      const query::MotionGuide asked = small.reduced(subject.asked);
      judged.verdict =
          judging::judge(judged.film, subject.kind, {.direction = asked.direction, .speed = asked.speed});
    } catch (const Error& fault) {
      if (i == 0 || fault.kind() == ErrorKind::kCancelled) throw;
      judged.failed = fault.what();
    }
    trial.takes.push_back(std::move(judged));
  }
  const double own = trial.takes.front().verdict.faults;
  for (std::size_t i = 1; i < trial.takes.size(); ++i) {
    const JudgedTake& take = trial.takes[i];
    if (take.failed.empty() && take.verdict.faults < own - options.margin &&
        take.verdict.faults < trial.takes[trial.best].verdict.faults)
      trial.best = i;
  }
  trial.seconds = watch.seconds();
  return trial;
}

std::string why(const Trial& trial, std::size_t take) {
  if (take == trial.best) return "chosen";
  const JudgedTake &one = trial.takes[take], &best = trial.takes[trial.best];
  if (!one.failed.empty()) return "not made: " + one.failed;
  double most = 0;
  judging::Measure measure{};
  for (std::size_t i = 0; i < one.verdict.findings.size(); ++i) {
    const double behind = one.verdict.findings[i].fault - best.verdict.findings[i].fault;
    if (behind > most) {
      most = behind;
      measure = one.verdict.findings[i].measure;
    }
  }
  if (most <= 0) return "no better than as asked";
  return fmt::format("{} ({:.2f}; chosen {:.2f})", judging::fault_words(one.verdict.of(measure)),
                     one.verdict.of(measure).reading.value, best.verdict.of(measure).reading.value);
}

}  // namespace freshet::synth::takes
