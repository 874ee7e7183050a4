// tools/options/search_options.h — which patches of a store may be candidates, and how they are searched.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "query/index/search_base.h"
#include "query/search/candidates.h"

namespace freshet::tools {

/// Which patches may be candidates.
class SearchOptions {
 public:
  void add_to(CLI::App& command);
  query::CandidateOptions options() const;
  query::IndexChoice index() const;
  /// --tolerance, which means something to a narrow search alone.
  const CLI::Option& tolerance() const { return *tolerance_option_; }
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
  CLI::Option *tolerance_option_ = nullptr, *checks_option_ = nullptr;
};

}  // namespace freshet::tools
