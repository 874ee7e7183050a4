// tools/options/cache_options.h — where results are kept from one run to the next.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "cache/result_cache.h"

namespace freshet::tools {

/// Freshet's folder for what can be made again: $XDG_CACHE_HOME/freshet or ~/.cache/freshet. As the XDG Base Directory
/// Specification has it, paths that are not absolute do not count.
/// Throws Error{kUsage} with `where` and `remedy` where neither variable names one.
std::filesystem::path user_cache_folder(const std::string& where, const std::string& remedy);

class CacheOptions {
 public:
  /// --cache, --cache-size.
  /// kept   what the folder will hold, and what that is good for.
  void add_to(CLI::App& command,
              const std::string& kept =
                  "candidates, tables and labels in this folder, and use what is there: after a "
                  "changed stroke only the pieces it touches are searched again");
  /// Null when none was asked for. Throws Error{kIo}, and Error{kUsage} for "auto" without a home.
  std::unique_ptr<cache::ResultCache> open() const;

 private:
  std::string folder_;
  int megabytes_ = 2048;
};

/// Writes what was kept, and says what was wrong. cache   may be null.
void finish_cache(cache::ResultCache* cache);

}  // namespace freshet::tools
