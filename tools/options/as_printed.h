// tools/options/as_printed.h — a method as its paper prints it, whole, in one word of the command line.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace freshet::tools {

/// An option and what the paper prints of it.
struct PrintedValue {
  std::string name;   // "--blend"
  std::string value;  // "paper"; of a flag "true" or "false"
  std::string where;  // "Sec. 6"
};

/// The option --as-printed. Stays where it is once it was added to a command line.
class AsPrinted {
 public:
  /// options   of `command`, which has them already.
  /// Returns the option.
  CLI::Option* add_to(CLI::App& command, const std::string& paper, std::vector<PrintedValue> options);
  /// Where it was asked for, gives every option of the list its printed value; once the command line is parsed, before
  /// options are read. Throws Error{kUsage} naming the option that was given another value.
  void apply() const;
  bool asked() const { return asked_; }

 private:
  CLI::App* command_ = nullptr;
  std::vector<PrintedValue> options_;
  bool asked_ = false;
};

}  // namespace freshet::tools
