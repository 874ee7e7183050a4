// tools/options/method_options.h — how frames are made, asked for on the command line.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "synth/animate/animate.h"

namespace freshet::tools {

/// An option for each of synth::animate::method_settings().
class MethodOptions {
 public:
  /// Stays where it is afterwards, as `command` does.
  void add_to(CLI::App& command);
  /// Throws Error{kUsage} naming an option that the method does without.
  synth::animate::Method method() const;
  /// --method is given.
  bool names_method() const { return !given_.empty() && !given_.front().empty(); }

 private:
  std::vector<std::string> given_;  // by setting; empty: its default
};

}  // namespace freshet::tools
