#include "store/store.h"

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

}  // namespace freshet::store
