#include "bench/quality/quality_hints.h"

#include <cmath>
#include <numbers>

#include "freshet/error.h"
#include "hints/motion_maps.h"
#include "query/labelling/motion_guess.h"

namespace freshet::bench {

const std::vector<NamedHint>& hints() {
  static const std::vector<NamedHint> all{
      {Hint::kNone, "none", "nothing is asked"},
      {Hint::kGuess, "guess", "nothing is asked, and a direction guessed, as the tools do by default"},
      {Hint::kDirection, "direction", "one direction for the whole picture"},
      {Hint::kStrokes, "strokes", "a few strokes, directions alone"},
      {Hint::kStrokesSpeed, "strokes+speed", "a few strokes with speeds"},
      {Hint::kMaps, "maps", "the clip's true mean motion as maps"},
  };
  return all;
}

const NamedHint& hint_named(const std::string& name) {
  std::string known;
  for (const NamedHint& one : hints()) {
    if (name == one.name) return one;
    known += std::string(known.empty() ? "" : ", ") + one.name;
  }
  throw Error(ErrorKind::kUsage, "hint \"" + name + "\"", "none of " + known);
}

AskedOf ask(Hint hint, const Case& clip, const store::Snapshot& snapshot, const query::SearchBase& base,
            const query::LabelOptions& options) {
  AskedOf asked{options.guide, options.guide};
  switch (hint) {
    case Hint::kNone:
      break;
    case Hint::kGuess: {
      const query::MotionGuess guess = query::guess_motion(
          snapshot, query::search_candidates(snapshot, base, clip.still, clip.matte, options), clip.still,
          clip.matte);
      if (guess.guide.empty()) break;
      asked.labels.direction = guess.guide.direction;
      asked.labels.tolerance_deg = guess.guide.tolerance_deg;
      break;
    }
    case Hint::kDirection: {
      const cv::Scalar mean = cv::mean(clip.motion, clip.matte > 127);
      const double speed = std::hypot(mean[0], mean[1]);
      if (speed <= 0) break;
      asked.direction = cv::Mat(clip.still.size(), CV_32FC2, cv::Scalar(mean[0] / speed, mean[1] / speed));
      if (options.hint_search == query::HintSearch::kWide) {
        asked.labels.direction = asked.rendering.direction = asked.direction;
        break;
      }
      asked.direction_deg = std::atan2(-mean[1], mean[0]) * 180 / std::numbers::pi;
      if (*asked.direction_deg < 0) *asked.direction_deg += 360;
      break;
    }
    case Hint::kStrokes:
    case Hint::kStrokesSpeed:
      if (clip.strokes.empty()) break;
      guide_by(clip.strokes, clip.still.size(), hint == Hint::kStrokesSpeed, asked.labels);
      asked.rendering = asked.labels;
      asked.direction = asked.labels.direction;
      break;
    case Hint::kMaps:
      hints::split_motion(clip.motion, clip.matte, asked.labels.direction, asked.labels.speed);
      asked.rendering = asked.labels;
      asked.direction = asked.labels.direction;
      break;
  }
  return asked;
}

}  // namespace freshet::bench
