// quality_hints.h — what a person may say of a picture's motion, from nothing to all of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/quality/quality_case.h"
#include "query/index/search_base.h"
#include "query/labelling/labelling.h"

namespace freshet::bench {

enum class Hint {
  kNone,          // nothing
  kGuess,         // nothing, and a direction is guessed (query::guess_motion): what the tools do by default
  kDirection,     // one direction for the whole picture: the clip's mean
  kStrokes,       // a few strokes, their directions alone
  kStrokesSpeed,  // the same with a speed each
  kMaps,          // the clip's true mean motion, pixel by pixel, as orientation and speed maps
};

struct NamedHint {
  Hint hint;
  const char *name, *what;
};
const std::vector<NamedHint>& hints();
/// Throws Error{kUsage} for an unknown name.
const NamedHint& hint_named(const std::string& name);

/// A hint as labelling and rendering take it.
struct AskedOf {
  query::MotionGuide labels, rendering;   // as the tools give them: rendering is not told what was guessed
  std::optional<double> direction_deg{};  // candidates' own: 0 right, 90 up
  cv::Mat direction{};  // CV_32FC2, unit vectors or (0, 0), the picture's size: what can be gone against;
                        // empty when nothing is asked
};

/// options   of the labelling that is to come: a guess searches with them, and tolerances are theirs.
/// A clip of which nothing can be said (no strokes, no mean direction) is asked nothing.
AskedOf ask(Hint hint, const Case& clip, const store::Snapshot& snapshot, const query::SearchBase& base,
            const query::LabelOptions& options);

}  // namespace freshet::bench
