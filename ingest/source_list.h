// source_list.h — which clips the given files and folders hold, under which names, in which order.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "platform/shard.h"

namespace freshet::ingest {

/// One clip to be: a video file, or a folder of numbered pictures.
struct Source {
  std::filesystem::path path;
  /// In the store: path relative to the folder given, '/' between parts; of a file given directly, its name.
  std::string name;
  std::string class_name;  // the folder that it lies in
  bool operator==(const Source&) const = default;
};

/// Walks folders to any depth; names that begin with a dot are passed over, links to folders are not
/// followed. In a folder, a file is a clip when media::looks_like_video says so; a file given directly always
/// is, so that the reader can say what is wrong with it. A folder that holds no video and at least
/// kMinSequence pictures, all of them numbered and the first as large as the last, is one clip.
///
/// The list is in media::natural_less order of names ("f9" before "f10", ties by bytes), the same on every
/// machine. The same path given twice is listed once.
///
/// Sources of equal contents are of one shard, so that of them the same one is ingested for any number of shards: of
/// one of several the first 64 KB of each source are read.
///
/// Throws Error{kInput} when a path does not exist or cannot be listed, and when there is no clip at all;
/// Error{kUsage} for a shard outside 1..count.
std::vector<Source> list_sources(std::span<const std::filesystem::path> paths, Shard shard = {});
inline constexpr int kMinSequence = 8;

/// XXH3-128 of names and sizes, as 32 hex digits: another list has another.
std::string list_hash(std::span<const Source> sources);

/// XXH3-128 of a file's bytes as 32 hex digits; for a folder, of the names and bytes of its pictures in
/// natural order, so that renaming the folder does not make another clip of it.
/// Throws Error{kInput} when it cannot be read. Memory: 1 MB.
std::string source_hash(const std::filesystem::path& path);

/// Of frames first to last - 1 of the source of that hash, as they are or made steady; likewise 32 hex digits.
std::string part_hash(const std::string& source_hash, int first, int last, bool steady = false);

}  // namespace freshet::ingest
