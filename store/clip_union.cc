#include "store/clip_union.h"

#include "freshet/error.h"

namespace freshet::store {

void ClipUnion::expect_settings(const std::filesystem::path& store, const std::string& settings) {
  if (first_.empty()) {
    first_ = store;
    settings_ = settings;
  }
  if (settings == settings_) return;
  throw Error(ErrorKind::kInput, store.string(), "has other settings than " + first_.string(),
              "Take stores that were made with the same settings (freshet store info shows them)");
}

const ClipUnion::Taken* ClipUnion::add(const std::filesystem::path& store, const ClipRecord& clip) {
  if (const auto same = by_source_.find(clip.source_hash); same != by_source_.end()) return &same->second;
  if (const auto taken = store_of_name_.find(clip.name); taken != store_of_name_.end())
    throw Error(
        ErrorKind::kInput, store.string(),
        "its clip \"" + clip.name + "\" comes from another source than that of " + taken->second.string(),
        "Ingest one of them under another name, or remove it first (freshet store remove)");
  by_source_.emplace(clip.source_hash, Taken{clip.name, store});
  store_of_name_.emplace(clip.name, store);
  return nullptr;
}

}  // namespace freshet::store
