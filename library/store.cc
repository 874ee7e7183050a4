#include "freshet/store.h"

#include "library/states.h"
#include "store/store.h"

namespace freshet {

std::shared_ptr<const query::SearchBase> Store::Impl::search_base() const {
  const std::lock_guard lock(guard_);
  if (!base_) base_ = std::make_shared<const query::SearchBase>(query::open_search(snapshot));
  return base_;
}

Store::Store(const std::filesystem::path& path)
    : impl_(std::make_shared<const Impl>(store::Store::open_read(path).snapshot())) {}

std::filesystem::path Store::path() const { return impl_->snapshot.path(); }

std::vector<Clip> Store::clips() const {
  std::vector<Clip> clips;
  for (const store::ClipId id : impl_->snapshot.clips()) {
    const store::ClipRecord& record = impl_->snapshot.clip(id);
    clips.push_back({.name = record.name,
                     .class_name = record.class_name,
                     .licence = record.licence,
                     .width = static_cast<int>(record.width),
                     .height = static_cast<int>(record.height),
                     .frames = record.frame_count,
                     .fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den),
                     .patches = record.rows});
  }
  return clips;
}

std::vector<std::uint64_t> Store::first_patches() const {
  std::vector<std::uint64_t> first{0};
  for (const store::ClipId id : impl_->snapshot.clips())
    first.push_back(first.back() + impl_->snapshot.clip(id).rows);
  return first;
}

std::string Store::digest() const { return impl_->snapshot.digest(); }

std::vector<std::string> Store::verify() const { return impl_->snapshot.verify(); }

}  // namespace freshet
