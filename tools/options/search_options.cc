#include "tools/options/search_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "freshet/error.h"
#include "media/picture/picture.h"
#include "query/search/picture_scale.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void TargetFiles::add_to(CLI::App& command) {
  command.add_option("STORE", store, "The store file")->required();
  command.add_option("PICTURE", picture, "The still picture (PNG, JPEG, TIFF, ...)")->required();
  CLI::Option* given = command.add_option("--matte", matte,
                                          "Grey picture, white where the fluid is [the picture's own alpha]");
  command.add_flag("--whole", whole, "All of the picture is fluid [off]")->excludes(given);
}

TargetFiles::Loaded TargetFiles::load() const {
  Loaded loaded{.picture = {}, .matte = {}, .still = media::read_still(picture)};
  for (const std::string& notice : loaded.still.notices) say(picture.string() + ": " + notice);
  loaded.picture = loaded.still.bgr;
  media::Matte read;
  if (!matte.empty()) {
    read = media::read_matte(matte, loaded.picture.size());
    for (const std::string& notice : read.notices) say(matte.string() + ": " + notice);
    if (!loaded.still.alpha.empty()) say(picture.string() + ": alpha channel ignored, as there is a matte");
  } else if (!loaded.still.alpha.empty() && !whole) {
    read = media::matte_of_alpha(loaded.still.alpha, picture);
    say(picture.string() + ": its alpha channel is the matte");
    for (const std::string& notice : read.notices) say(picture.string() + ": " + notice);
  }
  loaded.matte_known = whole || !read.alpha.empty();
  loaded.matte = read.alpha.empty() ? cv::Mat(loaded.picture.size(), CV_8U, cv::Scalar(255)) : read.alpha;
  return loaded;
}

TargetFiles::Loaded TargetFiles::load_with_matte() const {
  Loaded loaded = load();
  if (!loaded.matte_known)
    throw Error(
        ErrorKind::kUsage, picture.string(), "nothing says where its fluid is",
        "Give --matte (freshet synth matte makes one from a few strokes), a picture with alpha, or --whole "
        "where all of it moves");
  return loaded;
}

void say_reduction(const TargetFiles& target, const TargetFiles::Loaded& loaded) {
  if (!loaded.still.reduction.empty()) say(target.picture.string() + ": " + loaded.still.reduction);
}

void SearchOptions::add_to(CLI::App& command) {
  command.add_option("--class", options_.class_name,
                     "Only clips of this class (see freshet store info) [all]");
  command.add_option(
      "--direction", direction_,
      "Where the fluid goes: up, down, left, right, up-left, ..., or degrees (0 right, 90 up) [any]");
  command
      .add_option("--tolerance", options_.direction_tolerance_deg,
                  "Degrees to either side of what is asked, in a narrow search (--hint-search)")
      ->check(CLI::Range(1.0, 180.0))
      ->capture_default_str();
  command.add_option("-k,--candidates", options_.k, "Candidates per piece")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      .add_option("--coherent", options_.coherent,
                  "Of each neighbour's best candidates, how many are continued into a piece's own list")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  command.add_option("--min-scale", options_.min_scale, "Only patches of clips reduced to no less than this")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--max-rotation", options_.max_rotation_deg, "Only patches turned by no more, degrees")
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command.add_option("--exclude", options_.excluded_clips, "Leave this clip out; may be given several times");
  command
      .add_option("--piece", piece_,
                  "Side of the pieces that the picture is cut into, px: that of the store's patches (freshet "
                  "ingest --patch), which is all that it can be; another is refused [the store's]")
      ->check(CLI::Range(8, 1024));
  command
      .add_option(
          "--piece-scale", piece_scale_,
          "What the picture's sides are divided by before it is cut, 1 to 16; patches are shown enlarged by "
          "it. auto brings the longer side near 1280 px: 1 below 1600 px, 1.5 at 1920, 3 at 3840")
      ->check(CLI::IsMember({"auto"}) | CLI::Range(1.0, query::kMaxPieceScale))
      ->capture_default_str();
  command.add_option("--index", index_, "exact, or one of FLANN's that freshet index --flann has built")
      ->check(CLI::IsMember({"exact", "flann-kdtree", "flann-kmeans", "flann-hierarchical"}))
      ->capture_default_str();
  command
      .add_option(
          "--checks", flann_options_.checks,
          "Patches that a FLANN index looks at: recall for time. 0: as many as freshet index found it "
          "to need for a recall@100 of .9")
      ->check(CLI::Range(0, 1 << 24))
      ->capture_default_str();
}

query::CandidateOptions SearchOptions::options() const {
  query::CandidateOptions options = options_;
  if (!direction_.empty()) options.direction_deg = query::parse_direction(direction_);
  return options;
}

std::optional<double> SearchOptions::piece_scale() const {
  if (piece_scale_ == "auto") return std::nullopt;
  return std::stod(piece_scale_);
}

void SearchOptions::check(const store::Snapshot& snapshot) const {
  query::check_names(snapshot, options_);
  const int patch = vision::settings_from_json(snapshot.settings()).grid.patch;
  if (piece_ != 0 && piece_ != patch)
    throw Error(
        ErrorKind::kUsage, snapshot.path().string(),
        fmt::format("its patches are {} px wide, and pieces of {} px were asked for", patch, piece_),
        fmt::format("Make a store with freshet ingest --patch {}, or change how much of the picture a "
                    "piece covers with --piece-scale",
                    piece_));
}

query::IndexChoice SearchOptions::index() const {
  query::IndexChoice choice{.flann = {}, .flann_options = flann_options_};
  if (index_ != "exact") choice.flann = query::parse_flann_kind(index_.substr(std::string("flann-").size()));
  return choice;
}

void Duration::add_to(CLI::App& command) {
  command
      .add_option("--frames", frames,
                  "Frames of the animation; clips that do not last as long play by their loop rules")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command.add_option("--fps", fps, "Frames per second of the animation")
      ->check(CLI::Range(1.0, 240.0))
      ->capture_default_str();
}

void SolverOptions::add_to(CLI::App& command) {
  command.add_option("--solver", solver_, "trw-s (with a lower bound), alpha-expansion (the paper's), icm")
      ->check(CLI::IsMember({"trw-s", "alpha-expansion", "icm"}))
      ->capture_default_str();
  command.add_option("--iterations", iterations_, "Passes of the solver, at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command
      .add_option("--costs", costs_,
                  "log: distances of logarithms; power: the paper's, which drift to calm motion")
      ->check(CLI::IsMember({"log", "power"}))
      ->capture_default_str();
  lambda_option_ = command.add_option("--lambda", lambda_, "Weight of neighbours against likeness [0.01]")
                       ->check(CLI::NonNegativeNumber);
  sigma_option_ =
      command.add_option("--sigma", sigma_, "Weight of dynamics against mean motion [log 0.125, power 100]")
          ->check(CLI::NonNegativeNumber);
  vote_option_ =
      command
          .add_option("--vote", vote_,
                      "Weight of the candidates' vote on how strongly a piece moves [log 4, power 0]")
          ->check(CLI::NonNegativeNumber);
  command.add_option("--reuse", reuse_.overlap, "Price of a clip's place shown twice by neighbours")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command
      .add_option(
          "--crowd", reuse_.crowd,
          "Price of each patch of a clip that has more than half of the pieces; added up to four times")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  rho_option_ =
      command.add_option("--rho", rho_, "Weight of textureness against mean motion [log 0.25, power 10000]")
          ->check(CLI::NonNegativeNumber);
}

query::Minimizer SolverOptions::solver() const { return query::parse_minimizer(solver_); }

query::PairwiseOptions SolverOptions::costs() const { return costs(query::parse_cost_form(costs_)); }

query::PairwiseOptions SolverOptions::costs(query::CostForm form) const {
  query::PairwiseOptions costs = query::default_costs(form);
  if (lambda_option_->count() > 0) costs.lambda = lambda_;
  if (sigma_option_->count() > 0) costs.sigma = sigma_;
  if (rho_option_->count() > 0) costs.rho = rho_;
  if (vote_option_->count() > 0) costs.vote = vote_;
  return costs;
}

void say_filters(const query::Filtered& filtered, const Duration& duration) {
  std::string text;
  for (const query::FilterStep& step : filtered.steps)
    text += fmt::format("{}{}: {} patches of {} clips", text.empty() ? "" : "; ", step.what, step.patches,
                        step.clips);
  say(text);
  if (!filtered.too_short.empty())
    say(fmt::format("left out, as they do not last {:.2f} s ({} frames at {:g}/s) and have no loop rule: {}",
                    duration.seconds(), duration.frames, duration.fps, fmt::join(filtered.too_short, ", ")));
}

}  // namespace freshet::tools
