// platform/whole_file.h — files written, and compared, as a whole.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "freshet/error.h"

namespace freshet {

/// In place of what the file held. Throws Error{kIo} that names it.
inline void write_whole_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file << text;
  file.close();
  if (!file) throw Error(ErrorKind::kIo, path.string(), "cannot be written", "Check the folder and the disk");
}

/// False as well where one of them cannot be read.
inline bool same_bytes(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code fault;
  if (std::filesystem::file_size(one, fault) != std::filesystem::file_size(other, fault) || fault)
    return false;
  std::ifstream a(one, std::ios::binary), b(other, std::ios::binary);
  const std::istreambuf_iterator<char> end;
  return a && b && std::equal(std::istreambuf_iterator<char>(a), end, std::istreambuf_iterator<char>(b), end);
}

}  // namespace freshet
