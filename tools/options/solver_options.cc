#include "tools/options/solver_options.h"
#include "tools/console/run_context.h"

namespace freshet::tools {

void SolverOptions::add_to(CLI::App& command) {
  command.add_option("--solver", solver_, "trw-s (with a lower bound), alpha-expansion (the paper's), icm")
      ->check(CLI::IsMember({"trw-s", "alpha-expansion", "icm"}))
      ->capture_default_str()
      ->group(in_detail("Labelling"));
  command.add_option("--iterations", iterations_, "Maximum number of passes of the solver")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str()
      ->group(in_detail("Labelling"));
  command
      .add_option(
          "--costs", costs_,
          "Pairwise costs: log (distances of logarithms) or power (the paper's, which drift to calm motion)")
      ->check(CLI::IsMember({"log", "power"}))
      ->capture_default_str()
      ->group(in_detail("Labelling"));
  lambda_option_ = command.add_option("--lambda", lambda_, "Weight of neighbours against likeness [0.01]")
                       ->check(CLI::NonNegativeNumber)
                       ->group(in_detail("Labelling"));
  sigma_option_ =
      command.add_option("--sigma", sigma_, "Weight of dynamics against mean motion [log 0.125, power 100]")
          ->check(CLI::NonNegativeNumber)
          ->group(in_detail("Labelling"));
  vote_option_ =
      command
          .add_option("--vote", vote_,
                      "Weight of the candidates' vote on how strongly a piece moves [log 4, power 0]")
          ->check(CLI::NonNegativeNumber)
          ->group(in_detail("Labelling"));
  command
      .add_option("--reuse", reuse_.overlap,
                  "Cost of showing one place of a clip twice in neighbouring pieces")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str()
      ->group(in_detail("Labelling"));
  command
      .add_option(
          "--crowd", reuse_.crowd,
          "Cost of each patch of a clip that has more than half of 20 pieces or more; added up to four times")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str()
      ->group(in_detail("Labelling"));
  command
      .add_option(
          "--hint-weight", hint_weight_,
          "Weight, among a piece's candidates, of moving as asked; 0: of those that the search found, the "
          "looks alone choose, as they do in fires whose speed is asked")
      ->check(CLI::Range(0.0, 100.0))
      ->capture_default_str()
      ->group(in_detail("Labelling"));
  rho_option_ =
      command
          .add_option("--rho", rho_, "Weight of textureness, relative to mean motion [log 0.25, power 10000]")
          ->check(CLI::NonNegativeNumber)
          ->group(in_detail("Labelling"));
}

query::Minimizer SolverOptions::solver() const { return query::parse_minimizer(solver_); }

query::GuideCosts SolverOptions::guide_costs(query::HintSearch search) const {
  return query::weighted(query::default_guide_costs(search), hint_weight_);
}

query::PairwiseOptions SolverOptions::costs() const { return costs(query::parse_cost_form(costs_)); }

query::PairwiseOptions SolverOptions::costs(query::CostForm form) const {
  query::PairwiseOptions costs = query::default_costs(form);
  if (lambda_option_->count() > 0) costs.lambda = lambda_;
  if (sigma_option_->count() > 0) costs.sigma = sigma_;
  if (rho_option_->count() > 0) costs.rho = rho_;
  if (vote_option_->count() > 0) costs.vote = vote_;
  return costs;
}

}  // namespace freshet::tools
