// studio/studio.h — the studio without its server: projects, stores, and the work that is done for them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "cache/result_cache.h"
#include "studio/command_run.h"
#include "studio/easel.h"
#include "studio/event_feed.h"
#include "studio/job_queue.h"
#include "studio/opened_store.h"
#include "studio/project.h"
#include "studio/studio_folder.h"
#include "studio/ways/way_plan.h"

namespace freshet::studio {

struct StudioOptions {
  std::filesystem::path folder;               // projects/, stores/, incoming/, cache/ are made in it
  std::vector<std::filesystem::path> stores;  // opened beside those of the folder
  std::filesystem::path program;              // the executable that exports and ingests
};

/// What a page may ask for; texts are JSON. Safe from many threads.
/// Errors: Error{kNotFound} for what is not there, Error{kUsage} for what cannot be asked, Error{kInput} for what is
/// wrong with something that was sent.
class Studio {
 public:
  /// Throws as StudioFolder.
  explicit Studio(StudioOptions options);
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;
  ~Studio();

  EventFeed& feed() { return feed_; }
  /// For what is being sent.
  IncomingFile incoming_file() { return folder_.incoming_file(); }

  std::string home_json() const;
  /// Projects that hold the same picture already are opened again. file   moved.
  /// store   of the new document; "" : the only one that is open, or none. Returns its id.
  std::string open_picture(const std::filesystem::path& file, const std::string& name,
                           const std::string& store = {});
  void remove_project(const std::string& id);

  std::string thumbnail_of(const std::string& project) const { return thumbnail(project_folder(project)); }
  std::shared_ptr<Easel> easel(const std::string& project);
  /// Document, version, size and what has been computed; brings it up to date where it is not.
  std::string project_json(const std::string& project);
  /// Takes a changed document. Returns JSON with "version" and the "job" that brings it up to date, or with the document
  /// of somebody else where `base` is old.
  struct Saved {
    bool taken = false;
    std::string json;
  };
  Saved save_document(const std::string& project, std::string_view json, std::uint64_t base,
                      const std::string& page);
  void give_matte(const std::string& project, const std::filesystem::path& file);
  JobId update(const std::string& project);

  /// name   of the file in exports/, or with the ending of a picture of a folder of them. options   further words for
  /// `synth animate`: "--layer=fluid".
  JobId export_animation(const std::string& project, const std::string& name,
                         const std::vector<std::string>& options);
  std::string exports_json(const std::string& project);
  /// The command line that makes the same.
  static Command export_command(const std::string& program, const Project& project, const std::string& name,
                                const std::vector<std::string>& options);

  /// Another way to synthesise (ways/way_plan.h): its commands, run as one job. Told as "way" when its film is there.
  JobId run_way(const std::string& project, const std::string& way);
  /// Its "film", a number that another film does not have, or null; its "commands"; what the last one "found", and "made",
  /// a number as the film's, or null; and the names of what is "shown".
  std::string way_json(const std::string& project, const std::string& way);
  /// Throws Error{kNotFound} before it is made.
  std::shared_ptr<const OpenFile> film(const std::string& project, const std::string& way);
  /// A file that the way shows (WayPlan::shown). Throws Error{kNotFound}.
  std::shared_ptr<const OpenFile> way_file(const std::string& project, const std::string& way,
                                           const std::string& name);

  /// PNG, white, with the matte that a layer's scribbles mean as its alpha, for the eye: a draft. Throws Error{kNotFound}.
  std::string layer_matte_png(const std::string& project, std::uint64_t layer);

  /// The stills of the project's scene (still_folder.h).
  std::string stills_json(const std::string& project);
  std::string still_thumbnail(const std::string& project, const std::string& name);
  /// file   moved.
  void add_still(const std::string& project, const std::filesystem::path& file, const std::string& name);
  /// And what was made of them.
  void remove_stills(const std::string& project);

  /// A clip for the project alone (clip_folder.h). file   moved. Returns its name there.
  std::string add_clip(const std::string& project, const std::filesystem::path& file,
                       const std::string& name);
  std::string clips_json(const std::string& project);
  /// The first frame, as it is, JPEG. own   the project's, else its store's. Throws Error{kNotFound}, Error{kInput}.
  std::string clip_frame(const std::string& project, const std::string& clip, bool own);
  /// A project of the clip's first frame, begun with it; or the one that there is already. file   moved. Returns its id.
  std::string open_clip(const std::filesystem::path& file, const std::string& name);

  std::shared_ptr<OpenedStore> store(const std::string& id) const;
  /// A store's file, taken into the studio's folder; one of the same bytes and name is there once. file   moved.
  /// Returns its id. Throws Error{kInput} for what is none.
  std::string open_store(const std::filesystem::path& file, const std::string& name);
  /// A new, empty one in the studio's folder. Returns its id.
  std::string new_store(const std::string& name);
  /// Where a clip for a store is to be put before ingest. Throws Error{kUsage} for a name that is no video's.
  std::filesystem::path clip_path(const std::string& store, const std::string& class_name,
                                  const std::string& file);
  JobId ingest(const std::string& store, const std::string& licence);
  /// JPEG of clip_strip() of one of the clips that the last ingest was given, whether it was taken or not.
  /// Throws Error{kNotFound}.
  std::string screened_strip(std::uint64_t number) const;

  std::string jobs_json() const;
  bool stop_job(const std::string& lane, JobId id);
  /// Until no job waits or runs.
  void wait();

 private:
  void add_store(const std::filesystem::path& path);
  std::shared_ptr<OpenedStore> store_of(const Document& document) const { return store_at(document.store); }
  std::shared_ptr<OpenedStore> store_at(const std::string& path) const;  // null: it is not open
  WayPlan plan(const std::string& project, const std::string& way);
  /// Until the previews of a project have made what an animation reads of it. Throws Error{kUsage} where they could not,
  /// and Error{kCancelled}.
  void await_previews(const std::string& project, const Easel& easel, const Job& job) const;
  void tell_way(const std::string& project, const std::string& way);
  std::string likely_store() const;  // its path, for a new document; the guard is held
  /// Adds "strip", a number, to what ingest reports of each clip, of the first kMostStrips that can be decoded.
  void add_strips(const std::filesystem::path& clips, nlohmann::json& report);
  std::filesystem::path project_folder(const std::string& id) const;
  JobQueue::Watcher watcher(const char* lane);

  StudioOptions options_;
  StudioFolder folder_;
  EventFeed feed_;
  mutable std::mutex guard_;
  std::map<std::string, std::shared_ptr<OpenedStore>> stores_;  // by id
  std::map<std::string, std::shared_ptr<Easel>> easels_;        // by project; at most kMostEasels
  std::vector<std::string> recently_;                           // projects of easels_, last used last
  std::unique_ptr<cache::ResultCache> cache_;
  std::map<std::uint64_t, std::string> strips_;    // of the last ingest's clips
  std::unique_ptr<JobQueue> previews_, commands_;  // last: they use all of the above
};

}  // namespace freshet::studio
