// tools/options/settings_options.h — the options that fix a store's settings when it is made.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "vision/settings.h"

namespace freshet::tools {

class SettingsOptions {
 public:
  void add_to(CLI::App& command);
  /// The settings that the options describe. Throws Error{kUsage} when two of them do not go together: found
  /// later, the store would be there and of no use.
  vision::Settings for_new_store() const;
  /// A store's settings do not change once it holds clips. Throws Error{kUsage} naming the first option that
  /// was given and says otherwise than the store.
  void check_against(const vision::Settings& settings, const std::string& store) const;

 private:
  vision::Settings described() const;

  vision::Settings settings_;
  std::string flow_ = "dis";
  bool no_flips_ = false;
  // An option, and where to_json has what it sets.
  struct Described {
    const CLI::Option* option;
    std::string at;
  };
  std::vector<Described> options_;
  const CLI::Option* stride_ = nullptr;
};

}  // namespace freshet::tools
