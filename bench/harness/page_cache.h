// bench/harness/page_cache.h — what the system has of a file in memory.
#pragma once

#include <filesystem>

namespace freshet::bench {

/// Fraction of a file's pages in the system's cache, 0..1.
double cached_fraction(const std::filesystem::path& file);

/// Asks the system to forget the file's pages; those that another process maps stay.
void drop_from_cache(const std::filesystem::path& file);

}  // namespace freshet::bench
