// tools/options/motion_options.h — the options that say how the fluid is to move, and show how it does.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "hints/strokes.h"
#include "query/search/motion_guide.h"
#include "tools/options/search_options.h"
#include "tools/options/target_files.h"

namespace freshet::tools {

/// What strokes and maps ask of one picture.
struct AskedMotion {
  query::MotionGuide guide;            // empty: nothing was asked
  std::vector<hints::Stroke> strokes;  // as read, for the drawing
  bool guesses = true;                 // where nobody says a direction, one may be guessed
  query::HintSearch search = query::HintSearch::kWide;
};

class MotionOptions {
 public:
  /// --hint, --hint-search, --strokes, --orientation-map, --speed-map, --speed-white, --speed-tolerance, --draw.
  void add_to(CLI::App& command);
  /// Of these, what says how patches are searched: --hint, --hint-search, --speed-tolerance.
  void add_search_to(CLI::App& command);
  /// --horizon: for commands that make frames.
  void add_rendering_to(CLI::App& command);
  /// --orientation-out, --speed-out: for commands that assign patches.
  void add_outputs_to(CLI::App& command);

  /// Throws for outputs whose names are wrong, before anything is computed.
  void check_outputs() const;
  /// Reads what was given; says what was left out. Throws Error{kUsage} for options of a narrow search in a wide one,
  /// and for --speed-white without a map of speeds. The tolerance in degrees is that of --direction.
  /// automatic   what --hint-search auto means.
  AskedMotion read(const TargetFiles::Loaded& loaded, const SearchOptions& search,
                   query::HintSearch automatic = query::HintSearch::kWide) const;

  /// Writes --draw: what was asked, or what was assigned where nothing was.
  /// motion   the assigned motion, CV_32FC2, px/s; empty when nothing was assigned yet.
  void draw(const TargetFiles::Loaded& loaded, const AskedMotion& asked, const cv::Mat& motion) const;
  /// Writes the maps of assigned motion; says when white is too dark for it.
  void write_maps(const TargetFiles::Loaded& loaded, const cv::Mat& motion) const;
  /// Whether draw() or write_maps() needs the assigned motion.
  bool needs_motion(const AskedMotion& asked) const {
    return !orientation_out_.empty() || !speed_out_.empty() || (!drawing_.empty() && asked.guide.empty());
  }
  /// Of the files written, for the command's last lines.
  std::vector<std::string> outputs() const { return {drawing_, orientation_out_, speed_out_}; }

 private:
  std::string hint_ = "auto", hint_search_ = "auto", strokes_, orientation_map_, speed_map_, drawing_,
              orientation_out_, speed_out_, horizon_;
  double speed_white_ = 0, speed_ratio_ = 0;
  CLI::Option *speed_white_option_ = nullptr, *speed_tolerance_option_ = nullptr;
};

}  // namespace freshet::tools
