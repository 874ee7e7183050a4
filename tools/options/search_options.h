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
  /// Before long work. Throws Error{kUsage} for --checks without an index that has any, Error{kNotFound} for a class or
  /// a clip that the store does not have.
  void check(const store::Snapshot& snapshot) const;

 private:
  query::CandidateOptions options_;
  query::FlannOptions flann_options_;
  std::string direction_, index_ = "exact", piece_scale_ = "auto";
  CLI::Option *tolerance_option_ = nullptr, *checks_option_ = nullptr;
};

}  // namespace freshet::tools
