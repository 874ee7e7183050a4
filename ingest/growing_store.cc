#include "ingest/growing_store.h"

#include "freshet/error.h"
#include "store/store_list.h"
#include "stored/store_settings.h"

namespace freshet::ingest {

GrowingStore::GrowingStore(const std::filesystem::path& path, std::span<const std::filesystem::path> sources,
                           Shard shard, const std::function<vision::Settings()>& for_new)
    : path_(path) {
  store::expect_one_store(path);
  list_sources(sources, shard);
  is_new_ = !std::filesystem::exists(path);
  if (is_new_) {
    const std::string text = vision::to_json(for_new());
    vision::settings_from_json(text);  // what could not be read again is not written
    store_ = store::Store::create(path, text);
  } else {
    store_ = store::Store::open_write(path);
  }
  settings_ = stored::settings_of(store_->snapshot());
}

bool GrowingStore::remove_if_empty() {
  if (!store_->snapshot().clips().empty()) return false;
  if (is_new_) {
    store_.reset();
    std::filesystem::remove(path_);
    std::filesystem::remove(path_.string() + "-lock");
  }
  return true;
}

}  // namespace freshet::ingest
