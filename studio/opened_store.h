// studio/opened_store.h — a store that the studio has open: its clips, its search, and strips of its clips.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "freshet/job.h"
#include "query/index/search_base.h"
#include "store/store.h"
#include "stored/decoded_tiles.h"
#include "studio/clip_strip.h"

namespace freshet::studio {

/// A store as it was at one moment, with what a search needs of it.
struct StoreBase {
  store::Snapshot snapshot;
  query::SearchBase base;
  std::shared_ptr<ClipSamples> samples;
  std::shared_ptr<stored::DecodedTiles> tiles;  // of its previews
};

/// Opened once, and shared by all that is done with it. Safe from many threads.
class OpenedStore {
 public:
  /// path   of a store, or of one that is yet to be made by ingest.
  explicit OpenedStore(std::filesystem::path path);

  const std::string& id() const { return id_; }  // short, of the path
  const std::filesystem::path& path() const { return path_; }
  bool exists() const;
  /// Throws as store::Store::open_read.
  store::Snapshot snapshot() const;
  /// Opened by the first who asks: 1.6 us and 620 bytes per patch. Throws as query::open_search.
  std::shared_ptr<const StoreBase> base(const ProgressFunction& progress = {}) const;
  /// What was added since is seen from now on.
  void refresh();

  /// Name, path, clips and classes, for the page; "fault" where it cannot be read.
  std::string to_json() const;
  /// JPEG of clip_strip(), kept. clip   its place in the store. Throws Error{kNotFound}.
  std::string strip(std::size_t clip, int width) const;

 private:
  std::shared_ptr<ClipSamples> samples() const;

  std::filesystem::path path_;
  std::string id_;
  mutable std::mutex guard_;
  mutable std::optional<store::Store> store_;
  mutable std::optional<store::Snapshot> snapshot_;
  mutable std::shared_ptr<ClipSamples> samples_;
  mutable std::mutex base_guard_;  // held while the base is opened
  mutable std::shared_ptr<const StoreBase> base_;
  mutable std::mutex strips_guard_;
  mutable std::map<std::pair<std::size_t, int>, std::string> strips_;
};

}  // namespace freshet::studio
