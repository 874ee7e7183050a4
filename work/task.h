// work/task.h — a command shared out over machines: one shard of it is a task.
#pragma once

#include <string>
#include <vector>

#include "platform/shard.h"

namespace freshet::work {

/// A command that knows --shard and --gather: freshet ingest, or freshet synth sweep.
class SharedCommand {
 public:
  /// words   without the program's name: "ingest", "all.store", "footage".
  /// Throws  Error{kUsage} for another command, for an option that the worker gives (--shard, --seal, --gather,
  ///         --threads), and for more than 1,000 words or 100,000 bytes.
  explicit SharedCommand(std::vector<std::string> words);

  /// As it was given.
  const std::vector<std::string>& words() const { return words_; }
  /// What makes one shard, seals it, and leaves one that is sealed.
  std::vector<std::string> shard_words(Shard shard) const;
  /// What makes one of all shards.
  std::vector<std::string> gather_words() const;

 private:
  std::vector<std::string> words_;
};

inline constexpr int kMaxShards = 1'000'000;

struct Task {
  SharedCommand command;
  Shard shard;

  /// One line of JSON: {"run": [...], "shard": [3, 8]}.
  std::string text() const;
  /// Of 32 hex digits: equal for equal tasks.
  std::string key() const;
};

/// Throws Error{kInput} for a text that is no task, and as SharedCommand.
Task read_task(const std::string& text);

}  // namespace freshet::work
