#include "tools/options/cache_options.h"

#include <cstdlib>
#include <filesystem>

#include "freshet/error.h"
#include "tools/console/run_context.h"

namespace freshet::tools {
std::filesystem::path user_cache_folder(const std::string& where, const std::string& remedy) {
  for (const auto& [variable, below] : {std::pair{"XDG_CACHE_HOME", ""}, std::pair{"HOME", ".cache"}}) {
    const char* value = std::getenv(variable);
    if (value != nullptr && value[0] == '/') return std::filesystem::path(value) / below / "freshet";
  }
  throw Error(ErrorKind::kUsage, where, "neither XDG_CACHE_HOME nor HOME is set", remedy);
}

void CacheOptions::add_to(CLI::App& command, const std::string& kept) {
  const std::string group = "Cache";
  CLI::Option* const cache =
      command
          .add_option("--cache", folder_,
                      "Keep " + kept + ". auto: $XDG_CACHE_HOME/freshet or ~/.cache/freshet [none]")
          ->type_name("DIR")
          ->group(group);
  command
      .add_option("--cache-size", megabytes_,
                  "Size of the cache, MB; the least recently used results go first")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str()
      ->needs(cache)
      ->group(in_detail(group));
}

std::unique_ptr<cache::ResultCache> CacheOptions::open() const {
  if (folder_.empty()) return nullptr;
  return std::make_unique<cache::ResultCache>(
      folder_ == "auto" ? user_cache_folder("--cache auto", "Name a folder") : std::filesystem::path(folder_),
      static_cast<std::uintmax_t>(megabytes_) << 20);
}

void finish_cache(cache::ResultCache* cache) {
  if (cache == nullptr) return;
  cache->finish();
  for (const std::string& notice : cache->take_notices()) say(notice);
}

}  // namespace freshet::tools
