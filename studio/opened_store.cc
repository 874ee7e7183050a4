#include "studio/opened_store.h"

#include <functional>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "freshet/error.h"

namespace freshet::studio {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostStrips = 256;
constexpr std::size_t kTileBytes = std::size_t{512} << 20;

std::string short_hash(const std::string& text) {
  return fmt::format("{:016x}", std::hash<std::string>()(text)).substr(0, 10);
}

}  // namespace

OpenedStore::OpenedStore(std::filesystem::path path)
    : path_(std::move(path)), id_(short_hash(path_.string())) {}

bool OpenedStore::exists() const {
  std::error_code fault;
  return std::filesystem::is_regular_file(path_, fault);
}

store::Snapshot OpenedStore::snapshot() const {
  const std::lock_guard lock(guard_);
  if (!store_) store_ = store::Store::open_read(path_);
  if (!snapshot_) snapshot_ = store_->snapshot();
  return *snapshot_;
}

std::shared_ptr<ClipSamples> OpenedStore::samples() const {
  const store::Snapshot seen = snapshot();
  const std::lock_guard lock(guard_);
  if (!samples_) samples_ = std::make_shared<ClipSamples>(seen);
  return samples_;
}

std::shared_ptr<const StoreBase> OpenedStore::base(const ProgressFunction& progress) const {
  const store::Snapshot snapshot = this->snapshot();
  const std::lock_guard lock(base_guard_);
  if (!base_) {
    if (progress) progress({"reading the index", 0, 0});
    base_ = std::make_shared<const StoreBase>(
        StoreBase{snapshot, query::open_search(snapshot), samples(),
                  std::make_shared<stored::DecodedTiles>(snapshot, kTileBytes)});
  }
  return base_;
}

void OpenedStore::refresh() {
  {
    const std::scoped_lock lock(guard_, base_guard_);
    snapshot_.reset();
    samples_.reset();
    base_.reset();
  }
  const std::lock_guard lock(strips_guard_);
  strips_.clear();
}

std::string OpenedStore::to_json() const {
  Json json{{"id", id_}, {"name", path_.stem().string()}, {"path", path_.string()}, {"clips", Json::array()}};
  std::uint64_t patches = 0;
  try {
    if (exists()) {
      const store::Snapshot seen = snapshot();
      for (const store::ClipId id : seen.clips()) {
        const store::ClipRecord& clip = seen.clip(id);
        patches += clip.rows;
        json["clips"].push_back(
            {{"name", clip.name},
             {"class", clip.class_name},
             {"licence", clip.licence},
             {"width", clip.width},
             {"height", clip.height},
             {"frames", clip.frame_count},
             {"fps", static_cast<double>(clip.fps_num) / static_cast<double>(clip.fps_den)},
             {"patches", clip.rows}});
      }
    }
  } catch (const Error& fault) {
    json["fault"] = fault.what();
  }
  json["patches"] = patches;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string OpenedStore::strip(std::size_t clip, int width) const {
  {
    const std::lock_guard lock(strips_guard_);
    const auto found = strips_.find({clip, width});
    if (found != strips_.end()) return found->second;
  }
  const store::Snapshot seen = snapshot();
  if (clip >= seen.clips().size())
    throw Error(ErrorKind::kNotFound, path_.string(), fmt::format("there is no clip {}", clip));
  std::string strip = encoded(clip_strip(*samples()->frames(seen.clips()[clip]), width));
  const std::lock_guard lock(strips_guard_);
  if (strips_.size() >= kMostStrips) strips_.clear();
  strips_[{clip, width}] = strip;
  return strip;
}

}  // namespace freshet::studio
