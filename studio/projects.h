// studio/projects.h — the projects of a studio's folder: opened, changed, and brought up to date.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "cache/result_cache.h"
#include "studio/easel.h"
#include "studio/jobs/jobs.h"
#include "studio/project.h"
#include "studio/stores.h"
#include "studio/studio_folder.h"

namespace freshet::studio {

/// Texts are JSON. Safe from many threads.
/// Errors: Error{kNotFound} for a project that is not there, Error{kUsage} for what cannot be asked, Error{kInput} for
/// what is wrong with something that was sent.
class Projects {
 public:
  /// All must outlive this.
  Projects(StudioFolder& folder, Jobs& jobs, Stores& stores);
  Projects(const Projects&) = delete;
  Projects& operator=(const Projects&) = delete;

  /// "id" and "seconds_ago" of each, the last that was changed first.
  nlohmann::json list() const;
  /// Projects that hold the same picture already are opened again. file   moved.
  /// store   of the new document; "": Stores::likely(). Returns its id.
  std::string open_picture(const std::filesystem::path& file, const std::string& name,
                           const std::string& store = {});
  /// Throws Error{kIo} where its folder cannot be removed whole.
  void remove(const std::string& id);
  /// Returns the new id, of project_name(name). Throws Error{kUsage} where another project has it.
  std::string rename(const std::string& id, const std::string& name);
  /// A copy, without what was exported and what the ways made. longest   px that its picture is reduced to, and what
  /// was drawn is left out; 0: as it is. Returns its id. Throws Error{kIo} where it cannot be written.
  std::string duplicate(const std::string& id, int longest);
  std::string thumbnail_of(const std::string& project) const { return thumbnail(folder_of(project)); }
  std::shared_ptr<Easel> easel(const std::string& project);
  /// Document, version, size and what has been computed; brings it up to date where it is not.
  std::string to_json(const std::string& project);
  /// Takes a changed document. Returns JSON with "version" and the "job" that brings it up to date, or with the
  /// document of somebody else where `base` is old.
  struct Saved {
    bool taken = false;
    std::string json;
  };
  Saved save(const std::string& project, std::string_view json, std::uint64_t base, const std::string& page);
  /// name   that a person knows the file by, for what is wrong with it; may be empty.
  void give_matte(const std::string& project, const std::filesystem::path& file, const std::string& name);
  JobId update(const std::string& project);
  /// Takes of its animation (Easel::find_takes), in the lane of previews: the next change stops them.
  JobId find_takes(const std::string& project);
  /// Its scene in layers, moving (Easel::show_layers), in the live lane: the next one takes its place.
  JobId show_layers(const std::string& project, int first);
  /// Until the previews of a project have made what an animation reads of it. Throws Error{kUsage} where they could
  /// not, and Error{kCancelled}.
  void await_previews(const std::string& project, const Easel& easel, const Job& job);

 private:
  std::filesystem::path folder_of(const std::string& id) const;
  void stop_previews(const std::string& id);  // its takes and its layers too
  void forget(const std::string& id);         // the guard is held
  std::string reduced(const std::string& id, int longest);

  StudioFolder& folder_;
  Jobs& jobs_;
  Stores& stores_;
  cache::ResultCache cache_;
  mutable std::mutex guard_;
  std::map<std::string, std::weak_ptr<Easel>> easels_;  // by project; a job may hold one that is not kept
  std::vector<std::pair<std::string, std::shared_ptr<Easel>>> kept_;  // at most kMostEasels, last used last
};

}  // namespace freshet::studio
