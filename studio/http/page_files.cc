#include "studio/http/page_files.h"

#include <system_error>

#include "freshet/error.h"
#include "platform/text_file.h"

namespace freshet::studio {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFiles = 64, kMostBytes = 32u << 20;
constexpr const char* kRemedy =
    "Build it with ./demo.sh --studio, or configure with -DFRESHET_STUDIO_PAGE=ON";

const std::map<std::string, std::string>& types() {
  static const std::map<std::string, std::string> by_ending{{".html", "text/html; charset=utf-8"},
                                                            {".js", "text/javascript; charset=utf-8"},
                                                            {".css", "text/css; charset=utf-8"},
                                                            {".woff2", "font/woff2"},
                                                            {".svg", "image/svg+xml"},
                                                            {".png", "image/png"},
                                                            {".jpg", "image/jpeg"},
                                                            {".webp", "image/webp"},
                                                            {".webmanifest", "application/manifest+json"},
                                                            {".txt", "text/plain; charset=utf-8"}};
  return by_ending;
}

}  // namespace

std::map<std::string, PageFile, std::less<>> read_page(const fs::path& folder) {
  std::map<std::string, PageFile, std::less<>> files;
  std::error_code fault;
  std::size_t bytes = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, fault)) {
    const auto type = types().find(entry.path().extension());
    if (type == types().end() || !entry.is_regular_file()) continue;
    PageFile file{.type = type->second, .bytes = read_text_file(entry.path(), kMostBytes, kRemedy)};
    bytes += file.bytes.size();
    files.emplace(entry.path().filename(), std::move(file));
    if (files.size() > kMostFiles || bytes > kMostBytes)
      throw Error(ErrorKind::kInput, folder.string(), "holds more than a page does", kRemedy);
  }
  if (!files.contains("index.html"))
    throw Error(ErrorKind::kNotFound, folder.string(), "the studio's page is not there", kRemedy);
  return files;
}

}  // namespace freshet::studio
