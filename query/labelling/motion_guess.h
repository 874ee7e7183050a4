// query/labelling/motion_guess.h — where the fluid of a picture probably goes, when nobody has said.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "query/labelling/labelling.h"
#include "query/search/motion_guide.h"
#include "store/store.h"

namespace freshet::query {

/// Two things speak for a direction, each as a logarithm of likelihood: their sum, averaged over
/// neighbours. Figures: docs/measurements/motion.md.
/// The candidates' own motion says nothing: every patch has its mirror image in the store, so that they cannot tell
/// left from right; with their votes a guess is 61 degrees off instead of 52.
struct GuessOptions {
  /// Of the classes' pull: how far the clips of a class go up or down together, by the store's own patches;
  /// each class counts by its fraction of the candidates.
  double gravity = 1;
  /// Of texture's axis, times its coherence 0..1: threads of a fall or a flame lie along their motion. Over
  /// 46 real stills the axis is 35 degrees off, where chance is 45, and 78 on glittering seas: it turns a
  /// pull, or blurs it, and never makes one.
  double edges = 4;
  double reach_px = 48;             // sigma over which neighbours speak for a piece: two pieces' stride
  double min_certainty = 0.15;      // length of the mean direction, 0..1, from which a piece dares
  double min_speed_px_per_s = 2.5;  // slower patches say nothing
};

/// What is thought of one piece.
struct PieceGuess {
  cv::Vec2f direction{0, 0};  // unit vector, x right, y down; (0, 0): nothing dared
  float certainty = 0;        // length of the mean direction: 1 sure, 0 no idea
};

struct MotionGuess {
  /// Directions, (0, 0) where nothing is dared; empty when nowhere. Its tolerance is the spread that goes
  /// with the mean certainty, 45 to 90 degrees.
  MotionGuide guide;
  std::vector<PieceGuess> pieces;
  std::string report;  // what was guessed and what it rests on, for a person; without a full stop
};

/// A hint for a picture that has none.
/// search    of this picture, asked for any motion: its candidates say what the picture shows, and the rows
///           that its filter allows say how such fluids move.
/// picture   CV_8UC3, of any size: brought to the size that was searched; the guide has the picture's.
/// matte     CV_8U, the picture's size: texture counts where it is above 127.
/// The same guess for any number of threads. Throws Error{kUsage} for other types or unlike sizes.
/// Cost      0.1 s for 640 x 360 px and 357,650 patches, one thread.
/// Source    our own; structure tensor after Bigun and Granlund 1987. Left and right cannot be told from a
///           still: where the axis lies level (seas, skies), nothing is dared.
MotionGuess guess_motion(const store::Snapshot& snapshot, const CandidateSearch& search,
                         const cv::Mat& picture, const cv::Mat& matte, const GuessOptions& options = {});

}  // namespace freshet::query
