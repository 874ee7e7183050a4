// quality_case.h — one clip as a question: a still of it, its known motion, and what it really did.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "bench/quality/quality_measures.h"
#include "bench/quality/quality_strokes.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::bench {

struct CaseOptions {
  int width =
      640;  // px; clips whose longer side is greater are reduced to it, and all cropped to whole blocks
  int frames = 75;  // at most
};

struct Case {
  std::string name, class_name;
  std::vector<std::string>
      same_scene;  // clips that show the same place, itself among them: left out together
  double fps = 25;
  std::vector<cv::Mat> truth;          // CV_8UC3: what the clip did around the still
  std::vector<cv::Mat> luma;           // CV_8U, of `truth`
  cv::Mat still;                       // CV_8UC3: the middle one of these
  cv::Mat matte;                       // CV_8U: where it really moves, soft at the edge
  std::vector<query::Stroke> strokes;  // empty where nothing flows
  Region region;
  Film film;                     // of the truth
  std::optional<Distance> half;  // the clip before its middle against the clip after it: the ceiling
  Distance frozen;               // the still for ever: the floor
};

/// Nothing when the clip is shorter than 24 frames or moves in less than 1 % of the picture; `why` says
/// which. settings   of the store: what counts as moving, and the lattice.
std::optional<Case> make_case(const store::Snapshot& snapshot, const vision::Settings& settings,
                              store::ClipId clip, const CaseOptions& options, std::string& why);

/// Luma of BGR frames, as the measures take it.
std::vector<cv::Mat> luma_of(const std::vector<cv::Mat>& frames);

}  // namespace freshet::bench
