// tools/options/solver_options.h — how one candidate for each piece is chosen.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "query/costs/guide_costs.h"
#include "query/costs/pairwise.h"
#include "query/costs/reuse.h"
#include "query/mrf/minimizer.h"

namespace freshet::tools {

/// How one candidate per piece is chosen.
class SolverOptions {
 public:
  void add_to(CLI::App& command);
  query::Minimizer solver() const;
  int iterations() const { return iterations_; }
  const query::ReuseCosts& reuse() const { return reuse_; }
  /// With the weight of --hint-weight.
  query::GuideCosts guide_costs(query::HintSearch search) const;
  query::PairwiseOptions costs() const;
  /// With another form than that of --costs, whose defaults hold where no weight was given.
  query::PairwiseOptions costs(query::CostForm form) const;

 private:
  std::string solver_ = "trw-s", costs_ = "log";
  int iterations_ = 100;
  query::ReuseCosts reuse_;
  double lambda_ = 0, sigma_ = 0, rho_ = 0, vote_ = 0, hint_weight_ = 1;
  CLI::Option *lambda_option_ = nullptr, *sigma_option_ = nullptr, *rho_option_ = nullptr,
              *vote_option_ = nullptr;
};

}  // namespace freshet::tools
