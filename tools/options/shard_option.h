// tools/options/shard_option.h — which part of a list a run takes, where many machines share it.
#pragma once

#include <cstddef>
#include <string>

#include <CLI/CLI.hpp>

namespace freshet::tools {

/// Every `count`-th of the list, beginning with the `index`-th (1-based): shards are disjoint, and together the list.
struct Shard {
  int index = 1, count = 1;
  bool takes(std::size_t i) const {
    return i % static_cast<std::size_t>(count) == static_cast<std::size_t>(index - 1);
  }
};

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
