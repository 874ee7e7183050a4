// tools/options/search_options.h — the options of every command that searches a store for a picture.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "media/picture/picture.h"
#include "query/costs/pairwise.h"
#include "query/costs/reuse.h"
#include "query/index/search_base.h"
#include "query/mrf/minimizer.h"
#include "query/search/candidates.h"

namespace freshet::tools {

/// What is searched for: a picture and where its fluid is.
struct TargetFiles {
  std::string store;
  std::filesystem::path picture, matte;

  bool whole = false;  // the whole picture is fluid, whatever its alpha says

  /// STORE, PICTURE, --matte, --whole.
  void add_to(CLI::App& command);
  struct Loaded {
    cv::Mat picture, matte;  // CV_8UC3, CV_8U
    media::Still still;      // with all that the file holds
    bool matte_known = false;
  };
  /// Reads both; says what had to be changed about them. Without a matte the picture's alpha is it; without that
  /// the whole picture is fluid.
  Loaded load() const;
  /// The same for what is rendered: throws Error{kUsage} where nobody says where the fluid is.
  Loaded load_with_matte() const;
};

/// Says that bits were lost, for commands that use eight of them.
void say_reduction(const TargetFiles& target, const TargetFiles::Loaded& loaded);

/// Which patches may be candidates.
class SearchOptions {
 public:
  void add_to(CLI::App& command);
  query::CandidateOptions options() const;
  query::IndexChoice index() const;
  /// Nothing for auto.
  std::optional<double> piece_scale() const;
  /// Before long work. Throws Error{kUsage} when pieces of another size were asked for than the store was made for,
  /// Error{kNotFound} for a class or a clip that it does not have.
  void check(const store::Snapshot& snapshot) const;

 private:
  query::CandidateOptions options_;
  query::FlannOptions flann_options_;
  std::string direction_, index_ = "exact", piece_scale_ = "auto";
  int piece_ = 0;
};

/// How long the animation is to be; clips that are shorter are no candidates.
struct Duration {
  int frames = 96;
  double fps = 25;

  void add_to(CLI::App& command);
  double seconds() const { return frames / fps; }
};

/// How one candidate per piece is chosen.
class SolverOptions {
 public:
  void add_to(CLI::App& command);
  query::Minimizer solver() const;
  int iterations() const { return iterations_; }
  const query::ReuseCosts& reuse() const { return reuse_; }
  query::PairwiseOptions costs() const;
  /// With another form than that of --costs, whose defaults hold where no weight was given.
  query::PairwiseOptions costs(query::CostForm form) const;

 private:
  std::string solver_ = "trw-s", costs_ = "log";
  int iterations_ = 100;
  query::ReuseCosts reuse_;
  double lambda_ = 0, sigma_ = 0, rho_ = 0, vote_ = 0;
  CLI::Option *lambda_option_ = nullptr, *sigma_option_ = nullptr, *rho_option_ = nullptr,
              *vote_option_ = nullptr;
};

/// Says what the filters left, and which clips were too short.
void say_filters(const query::Filtered& filtered, const Duration& duration);

}  // namespace freshet::tools
