// tools/options/cache_options.h — where results are kept from one run to the next.
#pragma once

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "query/labelling/label_cache.h"

namespace freshet::tools {

class CacheOptions {
 public:
  /// --cache, --cache-size.
  void add_to(CLI::App& command);
  /// Null when none was asked for. Throws Error{kIo}, and Error{kUsage} for "auto" without a home.
  std::unique_ptr<query::LabelCache> open() const;

 private:
  std::string folder_;
  int megabytes_ = 2048;
};

/// Writes what was kept, and says what was wrong. cache   may be null.
void finish_cache(query::LabelCache* cache);

}  // namespace freshet::tools
