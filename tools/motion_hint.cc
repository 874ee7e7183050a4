#include "tools/motion_hint.h"

#include "query/labelling/motion_guess.h"
#include "tools/console/progress.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

bool may_guess(const AskedMotion& asked, const query::CandidateOptions& options) {
  return asked.guesses && !asked.has_direction() && !options.direction_deg;
}

void guess_where_unasked(const store::Snapshot& snapshot, const query::SearchBase& base,
                         const TargetFiles::Loaded& loaded, const AskedMotion& asked,
                         query::LabelOptions& options, std::stop_token stop, query::LabellingMemo* memo) {
  if (!may_guess(asked, options.candidates)) return;
  Progress progress;
  progress.show("guessing the motion", 0, 0);
  query::LabelOptions unasked = options;
  unasked.guide = {};
  const query::MotionGuess guess = query::guess_motion(
      snapshot,
      query::search_candidates(snapshot, base, loaded.picture, loaded.matte, unasked, {}, stop, memo),
      loaded.picture, loaded.matte);
  progress.finish();
  say(guess.report + (options.candidates.class_name.empty() ? "; --class says what it is, " : "; ") +
      "--direction or --strokes where it goes, --hint none asks nothing");
  if (guess.guide.empty()) return;
  options.guide.direction = guess.guide.direction;
  options.guide.tolerance_deg = guess.guide.tolerance_deg;
}

}  // namespace freshet::tools
