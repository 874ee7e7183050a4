#include "tools/options/shard_option.h"

#include <cstdio>

#include "freshet/error.h"

namespace freshet::tools {

void ShardOption::add_to(CLI::App& command, const std::string& text) {
  command.add_option("--shard", text_, text)->type_name("I/N");
}

Shard ShardOption::read() const {
  Shard shard;
  if (!given()) return shard;
  char rest = 0;
  if (std::sscanf(text_.c_str(), "%d/%d%c", &shard.index, &shard.count, &rest) != 2 || shard.count < 1 ||
      shard.index < 1 || shard.index > shard.count)
    throw Error(ErrorKind::kUsage, "--shard " + text_, "expected I/N with 1 <= I <= N",
                "For example --shard 2/8");
  return shard;
}

}  // namespace freshet::tools
