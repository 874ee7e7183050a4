// quality_case.h — one clip as a question: a still of it, its known motion, and what it really did.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/quality/quality_footage.h"
#include "bench/quality/quality_measures.h"
#include "bench/quality/quality_strokes.h"
#include "vision/settings.h"

namespace freshet::bench {

struct Case {
  std::string name, class_name;
  std::vector<std::string>
      same_scene;  // clips that show the same place, itself among them: left out together
  double fps = 25;
  std::vector<cv::Mat> truth;          // CV_8UC3: what the clip did around the still
  std::vector<cv::Mat> luma;           // CV_8U, of `truth`
  std::vector<PairMotion> motions;     // of `luma`
  cv::Mat motion;                      // CV_32FC2, the picture's size, px/s: their mean over time
  cv::Mat still;                       // CV_8UC3: the middle one of these
  cv::Mat matte;                       // CV_8U: where it really moves, soft at the edge
  std::vector<hints::Stroke> strokes;  // empty where nothing flows
  Region region;
  Film film;                      // of the truth
  std::optional<Distance> half;   // the clip before its middle against the clip after it: the ceiling
  LifetimeCurve half_lifetime{};  // of that before
  Distance frozen;                // the still for ever: the floor
};

/// Nothing when the clip is shorter than 24 frames or moves in less than 1 % of the picture; `why` says
/// which. settings   of the store: what counts as moving, and the lattice.
/// Cost   flow once over all frames, and the measures of the clip and of its two halves.
std::optional<Case> make_case(Footage footage, const vision::Settings& settings, std::string& why);

/// Unit vectors of the clip's mean motion, CV_32FC2; (0, 0) where it does not move, or outside the matte.
cv::Mat true_direction(const Case& clip);

}  // namespace freshet::bench
