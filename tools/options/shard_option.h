// tools/options/shard_option.h — which part of a list a run takes, where many machines share it.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "platform/shard.h"

namespace freshet::tools {

class ShardOption {
 public:
  /// --shard.
  void add_to(CLI::App& command, const std::string& text);
  bool given() const { return !text_.empty(); }
  /// All of the list where it was not given. Throws Error{kUsage} for what is not I/N.
  Shard read() const;

 private:
  std::string text_;
};

}  // namespace freshet::tools
