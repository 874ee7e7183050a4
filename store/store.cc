#include "store/store.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

#include "freshet/error.h"
#include "store/page_check.h"
#include "store/store_impl.h"

namespace freshet::store {

Store Store::create(const std::filesystem::path& path, const std::string& settings,
                    std::optional<std::uint64_t> store_id) {
  Store store;
  store.impl_ = std::make_shared<Impl>();
  store.impl_->environment = Environment::create(path, settings, store_id);
  return store;
}

Store Store::open_read(const std::filesystem::path& path) {
  Store store;
  store.impl_ = std::make_shared<Impl>();
  store.impl_->environment = Environment::open(path, Access::kRead);
  return store;
}

Store Store::open_write(const std::filesystem::path& path) {
  Store store;
  store.impl_ = std::make_shared<Impl>();
  store.impl_->environment = Environment::open(path, Access::kWrite);
  return store;
}

const std::filesystem::path& Store::path() const { return impl_->environment->file(); }

Snapshot Store::snapshot() const {
  Snapshot snapshot;
  snapshot.impl_ = std::make_shared<const Snapshot::Impl>(impl_->environment);
  return snapshot;
}

void Store::compact() {
  std::shared_ptr<Environment>& environment = impl_->environment;
  const std::filesystem::path file = environment->file();
  const std::filesystem::path fresh = file.string() + ".compacting";
  if (environment->access() != Access::kWrite) {
    throw Error(ErrorKind::kUsage, file.string(), "is open for reading only", "Open it for writing");
  }
  if (environment.use_count() > 1) {
    throw Error(ErrorKind::kUsage, file.string(), "has snapshots or a writer in this process",
                "Drop them first");
  }
  if (!environment->lock_alone()) {
    throw Error(ErrorKind::kIo, file.string(), "is open in another process", "Close it there and run again");
  }
  // LMDB copies as many pages as each value's first one names.
  check_pages(environment->descriptor(), file, PageCheck::kAll);
  std::filesystem::remove(fresh);
  try {
    environment->copy_compact(fresh);
    std::filesystem::rename(fresh, file);
    sync_folder_of(file);
  } catch (const std::filesystem::filesystem_error& error) {
    throw Error(ErrorKind::kIo, file.string(), error.what(), "The store is as before; check its folder");
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(fresh, ignored);
    throw;
  }
  environment.reset();
  environment = Environment::open(file, Access::kWrite);
}

}  // namespace freshet::store
