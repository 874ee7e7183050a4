#include "store/store.h"

#include "freshet/error.h"
#include "store/store_impl.h"
#include "store/store_list.h"

namespace freshet::store {
namespace {

std::vector<std::shared_ptr<Environment>> opened(std::span<const std::filesystem::path> paths,
                                                 Access access) {
  std::vector<std::shared_ptr<Environment>> files;
  for (const std::filesystem::path& path : paths) files.push_back(Environment::open(path, access));
  return files;
}

}  // namespace

Store Store::create(const std::filesystem::path& path, const std::string& settings,
                    std::optional<std::uint64_t> store_id) {
  expect_store_name(path);
  Store store;
  store.impl_ = std::make_shared<Impl>(Impl{path, {Environment::create(path, settings, store_id)}});
  return store;
}

Store Store::open_read(const std::filesystem::path& path) { return open_read(std::span(&path, 1)); }

Store Store::open_read(std::span<const std::filesystem::path> paths) {
  if (paths.empty()) throw Error(ErrorKind::kUsage, "Store::open_read", "no store is named");
  std::vector<std::filesystem::path> files;
  for (const std::filesystem::path& path : paths)
    for (std::filesystem::path& file : stores_named(path)) files.push_back(std::move(file));
  Store store;
  store.impl_ = std::make_shared<Impl>(Impl{paths.front(), opened(files, Access::kRead)});
  return store;
}

Store Store::open_write(const std::filesystem::path& path) {
  Store store;
  store.impl_ = std::make_shared<Impl>(Impl{path, opened(stores_named(path), Access::kWrite)});
  return store;
}

const std::shared_ptr<Environment>& Store::Impl::only_file() const {
  if (files.size() == 1) return files.front();
  throw Error(ErrorKind::kUsage, path.string(), "a clip is added to one store, and this is a list of some",
              "Name one of them");
}

const std::filesystem::path& Store::path() const { return impl_->path; }

Snapshot Store::snapshot() const {
  Snapshot snapshot;
  if (impl_->files.size() == 1)
    snapshot.impl_ = std::make_shared<const Snapshot::Impl>(impl_->files.front());
  else
    snapshot.joined_ = std::make_shared<const Snapshot::Joined>(impl_->path, impl_->files);
  return snapshot;
}

}  // namespace freshet::store
