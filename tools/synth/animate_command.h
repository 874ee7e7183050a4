// tools/synth/animate_command.h — what freshet synth animate is asked, and the steps from there to its frames.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "query/labelling/assignment.h"
#include "synth/animate/animate.h"
#include "synth/animate/staging.h"
#include "synth/takes/take.h"
#include "tools/console/progress.h"
#include "tools/options/as_printed.h"
#include "tools/options/cache_options.h"
#include "tools/options/duration.h"
#include "tools/options/hold_options.h"
#include "tools/options/method_options.h"
#include "tools/options/motion_options.h"
#include "tools/options/outline_options.h"
#include "tools/options/output_options.h"
#include "tools/options/play_options.h"
#include "tools/options/search_options.h"
#include "tools/options/solver_options.h"
#include "tools/options/target_files.h"
#include "tools/query/label_run.h"

namespace freshet::tools {

/// The command's options, wherever they are parsed. Stays where it is once it was added to a command line.
struct AnimateCommand {
  TargetFiles target;
  HoldOptions hold;
  SearchOptions search;
  MotionOptions motion;
  Duration duration;
  SolverOptions labelling;
  CacheOptions cache;
  PlayOptions play;
  OutlineOptions outline;
  MethodOptions method;
  OutputOptions output;
  AsPrinted as_printed;  // of the command line alone
  std::string assignment, sheet, credits;
  int takes = 1;            // to try before one is made whole
  synth::takes::Open open;  // what they may vary
  bool json = false;

  /// All options, and what --help leaves to --help-all.
  void add_to(CLI::App& app);
  /// Those that say how an animation is made, whoever asks for it and wherever it goes.
  void add_making_to(CLI::App& app);
  /// Those that can only change which patches are chosen, or what is read from files.
  void add_choosing_to(CLI::App& app);
  /// Those that can only change which patches are chosen.
  void add_search_to(CLI::App& app);

  synth::animate::AnimateOptions rendering() const;
  std::vector<PlannedStage> stages() const;
  /// What a direction or speed that is asked does to the search, where nobody says so.
  query::HintSearch hint_search() const;
};

/// What its files hold and its options come to, before a patch is looked for.
struct AnimateInputs {
  TargetFiles::Loaded loaded;
  synth::animate::AnimateOptions options;
  AskedMotion asked;
  synth::animate::Playing playing;
  std::string pace{};  // PlayOptions::pace, until pace_it() has made it a factor
};
/// Says what had to be changed about the files. Throws as their readers.
AnimateInputs read_inputs(const AnimateCommand& command);

struct ChosenPatches {
  query::Assignment assignment;
  nlohmann::json labelled;  // null for an assignment from a file
  query::KindChoice kind{};
};

/// Where the base of a search comes from: one may serve many.
using BaseSource = std::function<std::shared_ptr<const query::SearchBase>(const SearchOptions&)>;

/// One patch for each piece, searched and labelled or read; asked.guide becomes what the animation is turned to.
/// cache   may be null.
ChosenPatches choose_patches(const AnimateCommand& command, const store::Snapshot& snapshot,
                             const TargetFiles::Loaded& loaded, AskedMotion& asked, const BaseSource& base,
                             cache::ResultCache* cache, const RunContext& context);

/// Makes a pace the factor of playing at which the assigned motion has it, and says so; "auto" yields to speeds that
/// are asked.
/// kind   of the fluid, a store's class.
void pace_it(const store::Snapshot& snapshot, AnimateInputs& inputs, const query::Assignment& assignment,
             const std::string& kind);

/// What the patches and the inputs come to.
synth::animate::Staging stage(const store::Snapshot& snapshot, const AnimateInputs& inputs,
                              const query::Assignment& assignment);
/// picture   of the inputs, as deep as its output asks.
synth::animate::AnimateReport render(const store::Snapshot& snapshot, const AnimateInputs& inputs,
                                     const synth::animate::Staging& staging, const cv::Mat& picture,
                                     const std::function<void(const cv::Mat&)>& sink,
                                     const ProgressFunction& progress, const RunContext& context);

}  // namespace freshet::tools
