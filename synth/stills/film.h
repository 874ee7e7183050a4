// synth/stills/film.h — a folder of stills made a film: the steps in their order, for program and library.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/job.h"
#include "synth/stills/edits.h"
#include "synth/stills/plan.h"
#include "synth/stills/rendering.h"
#include "synth/stills/still_set.h"

namespace freshet::synth::stills {

struct FilmOptions {
  double seconds = 8, fps = 25;  // 12.5 at most of a preview
  bool preview = false;          // small and fast: 480 px
  std::string camera = "auto";   // or "tripod", "hand"
  std::string level = "auto";    // or "on", "off": exposure and white balance matched
  std::filesystem::path regions{}, scribbles{};
  bool one_region = false;
  std::filesystem::path edits{};
  std::vector<StillPin> pins{};     // settle reads them from the edits
  std::vector<FrontEdit> fronts{};  // these too
  PlanOptions plan{};
  RenderOptions render{};
};

/// What options mean to each other: number of frames, a preview's sides and rate; reads the edits.
/// Throws   Error{kUsage}: regions said more than once; Error{kInput} as read_edits.
void settle(FilmOptions& options);

/// px, the longer side to which read_stills reduces; 0: none.
int largest_side(const FilmOptions& options);

/// Brings the stills onto each other and to one level where they need it; what was done is added to their notices.
/// Throws   as find_alignment.
void straighten(StillSet& set, const FilmOptions& options, const Job& job);

/// A film as it was decided.
struct Film {
  StillSet stills;             // straight; without the things in front, which the plan has
  std::vector<cv::Mat> small;  // at work size, 960 px at most, CV_8UC3
  Plan plan;
  RenderOptions render;              // widths in px of the work size
  std::vector<std::string> notices;  // for a person; all of them

  cv::Size size() const { return stills.size(); }
};

/// Regions and orders. options   settled. set   straight.
/// Throws   Error{kInput} as read_regions, scribbled_regions, propose_regions, make_plan, placed_pins, check_pins and
///          front_mattes, and naming a thing in front: its name is another's, or its kind or parts are said.
Film plan_film(StillSet set, const FilmOptions& options, const Job& job);

}  // namespace freshet::synth::stills
