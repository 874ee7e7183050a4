// store/lmdb_error.h — LMDB's return codes as errors of ours.
#pragma once

#include <filesystem>
#include <string>

namespace freshet::store {

/// doing   "cannot commit": what was being done when LMDB returned `code`.
[[noreturn]] void throw_lmdb(const std::filesystem::path& file, const std::string& doing, int code);

inline void check_lmdb(const std::filesystem::path& file, const char* doing, int code) {
  if (code != 0) throw_lmdb(file, doing, code);
}

}  // namespace freshet::store
