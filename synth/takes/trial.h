// synth/takes/trial.h — takes made small and short, and judged, so that the best can be made whole.
#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "query/labelling/assignment.h"
#include "store/store.h"
#include "synth/animate/animate.h"
#include "synth/animate/staging.h"
#include "synth/judging/critic.h"
#include "synth/takes/take.h"
#include "vision/settings.h"

namespace freshet::synth::takes {

struct TrialOptions {
  int side = 240;   // px, longer side of a take
  int frames = 32;  // at most
  /// Better than the take as asked by so many faults, or it stays: a person's own word weighs something.
  double margin = 0.5;
  bool with_innovations = false;  // a clip's pixels are read too: three times the time
};

/// What all takes share. Views of what outlives it.
struct Subject {
  const store::Snapshot& snapshot;
  const vision::Settings& settings;
  const cv::Mat &picture, &matte;  // CV_8UC3, CV_8U
  const query::Assignment& assignment;
  const query::MotionGuide& asked;  // of the animation
  const animate::Playing& playing;
  const animate::AnimateOptions& options;
  std::string kind{};
};

struct JudgedTake {
  Take take;
  judging::Evidence film;
  judging::Verdict verdict{};
  std::string failed{};  // why it could not be made, for a person; then it has no verdict
};

struct Trial {
  std::vector<JudgedTake> takes{};  // in the order of `takes`
  std::size_t best = 0;
  double half_life_s = 0;  // as asked, of whole frames
  double seconds = 0;      // on the wall's clock
};

/// Makes each take of the picture reduced to TrialOptions::side (the same patches on it, reduced alike; speeds, lives
/// and lengths with them), judges it, and says which is best: least faults, the earlier of two that are equal. Sinks of
/// the options are not called. Patches' residuals are left out (CarriedOptions::innovations): they make a take three
/// times as dear, and weigh on all takes alike.
/// Throws  what animate() throws of the take as asked; Error{kCancelled}. The same for any number of threads.
/// Cost    0.3 s of wall a take on two cores; labels are shared.
Trial try_takes(const Subject& subject, const std::vector<Take>& takes, const TrialOptions& options = {},
                const std::function<void(std::size_t)>& progress = {}, std::stop_token stop = {});

/// Why a take lost against the best, or "chosen": the measure in which it is behind most.
std::string why(const Trial& trial, std::size_t take);

}  // namespace freshet::synth::takes
