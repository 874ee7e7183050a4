#include "ingest/source_list.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <xxhash.h>

#include "freshet/error.h"
#include "media/frame/file_format.h"
#include "media/picture/picture.h"
#include "media/picture/picture_sequence.h"
#include "media/video/video_reader.h"
#include "platform/printable.h"
#include "platform/text.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool hidden(const fs::path& path) { return path.filename().string().starts_with('.'); }

bool numbered(const fs::path& path) {
  const std::string stem = path.stem().string();
  return !stem.empty() && is_digit(stem.back());
}

struct Listing {
  std::vector<fs::path> files, folders;
};

Listing list_folder(const fs::path& folder) {
  Listing listing;
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    if (hidden(entries->path())) continue;
    std::error_code unreadable;
    if (entries->is_directory(unreadable) && !entries->is_symlink(unreadable)) {
      listing.folders.push_back(entries->path());
    } else if (entries->is_regular_file(unreadable)) {
      listing.files.push_back(entries->path());
    }
  }
  if (error) {
    throw Error(ErrorKind::kInput, folder.string(), "the folder cannot be listed: " + error.message(),
                "Check its permissions");
  }
  const auto by_name = [](const fs::path& a, const fs::path& b) {
    return media::natural_less(a.filename().string(), b.filename().string());
  };
  std::ranges::sort(listing.files, by_name);
  std::ranges::sort(listing.folders, by_name);
  return listing;
}

/// Photographs of a trip are numbered too, but seldom of one size from the first to the last.
bool is_sequence(const std::vector<fs::path>& files) {
  std::vector<fs::path> pictures;
  std::ranges::copy_if(files, std::back_inserter(pictures), media::looks_like_picture);
  if (pictures.size() < static_cast<std::size_t>(kMinSequence) || !std::ranges::all_of(pictures, numbered)) {
    return false;
  }
  try {
    return media::read_picture(pictures.front()).bgr.size() ==
           media::read_picture(pictures.back()).bgr.size();
  } catch (const Error&) {
    return false;
  }
}

std::string name_in(const fs::path& root, const fs::path& path) {
  const fs::path relative = path.lexically_relative(root);
  return relative == "." ? root.filename().generic_string() : relative.generic_string();
}

/// `path` is absolute and normal, without a trailing '/'.
// A clip's name goes into tables, JSON and pages: it is text, whatever bytes the file's has.
Source make_source(const fs::path& path, const std::string& name) {
  return {path, printable(name), printable(path.parent_path().filename().string())};
}

void walk(const fs::path& root, const fs::path& folder, std::vector<Source>& sources) {
  const Listing listing = list_folder(folder);
  bool video = false;
  for (const fs::path& file : listing.files) {
    if (!media::looks_like_video(file)) continue;
    video = true;
    sources.push_back(make_source(file, name_in(root, file)));
  }
  if (!video && is_sequence(listing.files)) sources.push_back(make_source(folder, name_in(root, folder)));
  for (const fs::path& inner : listing.folders) walk(root, inner, sources);
}

/// Absolute, without '.', '..' and a trailing '/'.
fs::path settled_path(const fs::path& path) {
  fs::path normal = fs::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

struct HashState {
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state{XXH3_createState()};
  std::vector<char> buffer = std::vector<char>(1 << 20);

  HashState() { XXH3_128bits_reset(state.get()); }
  void add(std::string_view bytes) { XXH3_128bits_update(state.get(), bytes.data(), bytes.size()); }
  void add_file(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    while (file) {
      file.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
      add({buffer.data(), static_cast<std::size_t>(file.gcount())});
    }
    if (!file.eof()) {
      throw Error(ErrorKind::kInput, path.string(), "the file cannot be read",
                  "Check its permissions and disk");
    }
  }
  std::string hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    return freshet::hex(hash.high64) + freshet::hex(hash.low64);
  }
};

/// Equal for equal contents, and hardly ever for others: sizes, and the beginning of the first file.
std::string likely_content(const fs::path& path) {
  std::error_code error;
  std::vector<fs::path> files{path};
  if (fs::is_directory(path, error)) files = list_folder(path).files;
  std::erase_if(files,
                [&](const fs::path& file) { return file != path && !media::looks_like_picture(file); });
  std::string content;
  if (files.empty()) files = {path};  // it has changed since it was listed
  for (const fs::path& file : files) content += hex(fs::file_size(file, error));
  std::string beginning(std::size_t{1} << 16, '\0');
  std::ifstream first(files.front(), std::ios::binary);
  first.read(beginning.data(), static_cast<std::streamsize>(beginning.size()));
  HashState hash;
  hash.add({beginning.data(), static_cast<std::size_t>(first.gcount())});
  hash.add(content);
  return hash.hex();
}

}  // namespace

std::vector<Source> list_sources(std::span<const fs::path> paths, Shard shard) {
  if (shard.count < 1 || shard.index < 1 || shard.index > shard.count) {
    throw Error(ErrorKind::kUsage, fmt::format("shard {}/{}", shard.index, shard.count),
                "the first number must be 1 or more and at most the second");
  }
  std::vector<Source> all;
  for (const fs::path& given : paths) {
    const fs::path path = settled_path(given);
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) {
      throw Error(ErrorKind::kInput, given.string(), "there is no such file or folder", "Check the path");
    }
    if (fs::is_directory(status)) {
      walk(path, path, all);
    } else if (fs::is_regular_file(status)) {
      all.push_back(make_source(path, path.filename().string()));
    } else {
      throw Error(ErrorKind::kInput, given.string(), "is neither a regular file nor a folder",
                  "Give video files, or folders that hold some");
    }
  }
  if (all.empty()) {
    const std::string where = paths.empty() ? "ingest" : paths.front().string();
    throw Error(
        ErrorKind::kInput, where, "no clip was found",
        fmt::format("Give video files, folders that hold some, or a folder of at least {} numbered pictures "
                    "of one size",
                    kMinSequence));
  }
  std::ranges::sort(all, [](const Source& a, const Source& b) {
    return a.name != b.name ? media::natural_less(a.name, b.name) : a.path < b.path;
  });
  all.erase(std::ranges::unique(all, {}, &Source::path).begin(), all.end());

  if (shard.count == 1) return all;
  std::vector<Source> taken;
  std::map<std::string, std::size_t> order;  // of contents, as they come
  for (Source& source : all) {
    const std::size_t number = order.emplace(likely_content(source.path), order.size()).first->second;
    if (shard.takes(number)) taken.push_back(std::move(source));
  }
  return taken;
}

std::string source_hash(const fs::path& path) {
  HashState hash;
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    hash.add_file(path);
    return hash.hex();
  }
  for (const fs::path& file : list_folder(path).files) {
    if (!media::looks_like_picture(file)) continue;
    const std::string name = file.filename().string();
    hash.add({name.c_str(), name.size() + 1});  // with its zero: "a1","2" is not "a12",""
    hash.add(hex(fs::file_size(file, error)));
    hash.add_file(file);
  }
  return hash.hex();
}

std::string list_hash(std::span<const Source> sources) {
  HashState hash;
  std::error_code error;
  for (const Source& source : sources) {
    hash.add({source.name.c_str(), source.name.size() + 1});
    const bool file = !fs::is_directory(source.path, error);
    hash.add(hex(file ? fs::file_size(source.path, error) : list_folder(source.path).files.size()));
  }
  return hash.hex();
}

std::string part_hash(const std::string& source_hash, int first, int last, bool steady) {
  HashState hash;
  hash.add(fmt::format("{}:{}-{}{}", source_hash, first, last, steady ? ":steady" : ""));
  return hash.hex();
}

}  // namespace freshet::ingest
