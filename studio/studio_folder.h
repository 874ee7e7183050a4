// studio/studio_folder.h — the folder in which a studio keeps everything, its own for as long as it runs.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>

#include "studio/incoming_file.h"

namespace freshet::studio {

/// projects/, stores/, incoming/, cache/ are made in it. Safe from many threads.
class StudioFolder {
 public:
  /// Throws Error{kIo} when it cannot be made, or locked; Error{kInput} when another process has it, saying which.
  explicit StudioFolder(const std::filesystem::path& path);
  StudioFolder(const StudioFolder&) = delete;
  StudioFolder& operator=(const StudioFolder&) = delete;
  ~StudioFolder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path projects() const { return path_ / "projects"; }
  std::filesystem::path stores() const { return path_ / "stores"; }
  std::filesystem::path cache() const { return path_ / "cache"; }
  /// A new one at each call.
  IncomingFile incoming_file();
  /// Clips that wait for ingest into a store.
  std::filesystem::path incoming_clips(const std::string& store) const { return path_ / "incoming" / store; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
  std::atomic<std::uint64_t> incoming_{0};
};

/// Throws Error{kIo} when it cannot be made.
void make_folder(const std::filesystem::path& folder);

}  // namespace freshet::studio
