// ingest/growing_store.h — the store that clips are to be added to: the one that is there, or a new one.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>

#include "ingest/source_list.h"
#include "store/store.h"
#include "vision/settings.h"

namespace freshet::ingest {

class GrowingStore {
 public:
  /// Lists the sources first: a mistyped folder must not leave an empty store behind.
  /// for_new   asked only where there is no file yet.
  /// Throws    as list_sources, and as store::Store::create or open_write.
  GrowingStore(const std::filesystem::path& path, std::span<const std::filesystem::path> sources, Shard shard,
               const std::function<vision::Settings()>& for_new);

  /// Not after remove_if_empty().
  store::Store& store() { return *store_; }
  const vision::Settings& settings() const { return settings_; }
  bool is_new() const { return is_new_; }

  /// Whether it holds no clip. A new one is then removed: it is of no use, and would only surprise the next
  /// run.
  bool remove_if_empty();

 private:
  std::filesystem::path path_;
  bool is_new_ = false;
  std::optional<store::Store> store_;
  vision::Settings settings_;
};

}  // namespace freshet::ingest
