// studio/stores.h — the stores that the studio has open, and ingest into them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studio/jobs/jobs.h"
#include "studio/opened_store.h"
#include "studio/studio_folder.h"

namespace freshet::studio {

/// Safe from many threads. Throws Error{kNotFound} for a store that is not open.
class Stores {
 public:
  /// given   opened beside those of the folder. program   the executable that ingests. All must outlive this.
  Stores(StudioFolder& folder, Jobs& jobs, std::vector<std::filesystem::path> given,
         std::filesystem::path program);
  Stores(const Stores&) = delete;
  Stores& operator=(const Stores&) = delete;

  std::vector<std::shared_ptr<OpenedStore>> all() const;
  std::shared_ptr<OpenedStore> get(const std::string& id) const;
  std::shared_ptr<OpenedStore> at(const std::string& path) const;  // null: it is not open
  /// The path of one for a new document: the first that was given, or the one of most clips; "": there is none.
  std::string likely() const;

  /// A store's file, taken into the studio's folder; one of the same bytes and name is there once. file   moved.
  /// Returns its id. Throws Error{kInput} for what is none.
  std::string take(const std::filesystem::path& file, const std::string& name);
  /// A new, empty one in the studio's folder. Returns its id.
  std::string create(const std::string& name);
  /// Where a clip for a store is to be put before ingest. Throws Error{kUsage} for a name that is no video's.
  std::filesystem::path clip_path(const std::string& store, const std::string& class_name,
                                  const std::string& file);
  JobId ingest(const std::string& store, const std::string& licence);
  /// JPEG of clip_strip() of one of the clips that the last ingest was given, whether it was taken or not.
  std::string screened_strip(std::uint64_t number) const;

 private:
  void add(const std::filesystem::path& path);
  /// Adds "strip", a number, to what ingest reports of each clip, of the first kMostStrips that can be decoded.
  void add_strips(const std::filesystem::path& clips, nlohmann::json& report);

  StudioFolder& folder_;
  Jobs& jobs_;
  std::vector<std::filesystem::path> given_;
  std::filesystem::path program_;
  mutable std::mutex guard_;
  std::map<std::string, std::shared_ptr<OpenedStore>> stores_;  // by id
  std::map<std::uint64_t, std::string> strips_;                 // of the last ingest's clips
};

}  // namespace freshet::studio
