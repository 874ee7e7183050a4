// tools/console/toml_options.h — the file of --config, read as the TOML that it is.
#pragma once

#include <istream>
#include <vector>

#include <CLI/CLI.hpp>

namespace freshet::tools {

/// CLI11's own reader (2.1) cuts a quoted name at a '#', and takes one in brackets for a list: names of clips, which
/// are files, have both.
class TomlOptions : public CLI::ConfigBase {
 public:
  /// app   whose --config is read; outlives this.
  explicit TomlOptions(const CLI::App& app) : app_(app) {}
  /// A table for each command, below it a value, or a list of values, for each option.
  /// Throws Error{kUsage} naming the file, the line of what is no TOML, and the key of what is no value of an option.
  std::vector<CLI::ConfigItem> from_config(std::istream& stream) const override;

 private:
  const CLI::App& app_;
};

}  // namespace freshet::tools
