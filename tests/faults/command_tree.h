// tests/faults/command_tree.h — the commands of the executable and their options, as its own help lists them.
#pragma once

#include <string>
#include <vector>

#include "tests/faults/campaign.h"

namespace freshet::tools {

struct Option {
  std::string name;                    // "--frames"
  bool is_flag = false;                // takes no value
  std::vector<std::string> good = {};  // at the ends of what is allowed; empty where only a person knows
  std::vector<std::string> bad = {};   // must be refused
};

/// "synth animate", ...: those that run, in the order of help. Options of all take no part in them.
std::vector<std::string> commands_of(const Campaign& c);

/// All but --help and --help-all, with the types and ranges that --help-all or --help gives.
std::vector<Option> options_of(const Campaign& c, const std::string& command);

/// At spaces.
std::vector<std::string> words_of(const std::string& text);

}  // namespace freshet::tools
