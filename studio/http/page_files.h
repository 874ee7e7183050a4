// studio/http/page_files.h — the page as its build left it, in memory: no path of a request ever becomes one of the
// disk.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace freshet::studio {

struct PageFile {
  std::string type;  // "text/html; charset=utf-8"
  std::string bytes;
};

/// By name, "index.html"; folders below are not looked at.
/// Throws Error{kNotFound} when the folder holds no index.html, naming how it is built; Error{kInput} above 64 files or
/// 32 MB.
std::map<std::string, PageFile, std::less<>> read_page(const std::filesystem::path& folder);

}  // namespace freshet::studio
