#include "store/rewrite/rewrite.h"

#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <string_view>
#include <utility>

#include "freshet/error.h"
#include "store/clip_union.h"
#include "store/new_file.h"
#include "store/records/identity.h"
#include "store/rewrite/store_copy.h"
#include "store/store_list.h"

namespace freshet::store {
namespace {

/// All of a store, under its own id and numbers.
StoreCopy whole(const Contents& contents) {
  StoreCopy copy{.store_id = contents.store_id,
                 .settings = contents.settings,
                 .next_clip = contents.next_clip,
                 .blobs_from = &contents};
  for (const auto& [id, clip] : contents.clips) copy.clips.push_back({&contents, id, id});
  return copy;
}

void leave_out(StoreCopy& copy, const Rebuildable& index) {
  copy.without = index.columns;
  copy.without.insert(index.blobs.begin(), index.blobs.end());
}

/// Whether anything of an index is there to be left out.
bool has_index(const Contents& contents, const Rebuildable& index) {
  return std::ranges::any_of(contents.blobs, [&](const auto& b) { return index.blobs.contains(b.first); }) ||
         std::ranges::any_of(contents.clips, [&](const auto& clip) {
           return std::ranges::any_of(clip.second.columns,
                                      [&](const auto& c) { return index.columns.contains(c.first); });
         });
}

/// A store that is about to be replaced, and that nobody else has open.
class Replaced {
 public:
  explicit Replaced(const std::filesystem::path& file) {
    expect_one_store(file);
    file_ = std::filesystem::exists(file) ? std::filesystem::canonical(file) : file;  // a link stays one
    environment_ = Environment::open(file, Access::kWrite);
    if (!environment_->lock_alone())
      throw Error(ErrorKind::kIo, file.string(), "is open in another process",
                  "Close it there and run again");
    contents_ = read_contents(environment_);
  }
  const Contents& contents() const { return contents_; }

  FileSizes by(const StoreCopy& copy, const Job& job) const {
    FileSizes sizes{.before = environment_->file_bytes()};
    NewFile fresh(file_, Existing::kReplaced);
    sizes.after = write_copy(copy, fresh.descriptor(), environment_->file(), job);
    struct stat opened {
    }, named{};
    if (fstat(environment_->descriptor(), &opened) != 0 || ::stat(file_.c_str(), &named) != 0 ||
        opened.st_ino != named.st_ino || opened.st_dev != named.st_dev)
      throw Error(ErrorKind::kIo, environment_->file().string(), "has been moved away or replaced meanwhile",
                  "Run again");
    sizes.old_names = opened.st_nlink - 1;
    fresh.commit();
    return sizes;
  }

 private:
  std::filesystem::path file_;
  std::shared_ptr<Environment> environment_;
  Contents contents_;
};

/// Which clips of several stores are to be in one, those of `order` first.
void choose_clips(const std::vector<Contents>& stores, std::span<const std::string> order, StoreCopy& copy,
                  MergeReport& report) {
  ClipUnion all;
  for (const Contents& store : stores) {
    all.expect_settings(store.file, store.settings);
    for (const auto& [id, clip] : store.clips) {
      if (const ClipUnion::Taken* same = all.add(store.file, clip.record))
        report.doubles.push_back({clip.record.name, store.file.string(), same->name});
      else
        copy.clips.push_back({&store, id, id});
    }
  }
  std::map<std::string_view, std::size_t> places;
  for (const std::string& name : order) places.emplace(name, places.size());
  std::ranges::stable_sort(copy.clips, {}, [&](const StoreCopy::Clip& clip) {
    const auto place = places.find(clip.from->clips.at(clip.id).record.name);
    return place == places.end() ? places.size() : place->second;
  });
  for (StoreCopy::Clip& clip : copy.clips) clip.as = ClipId{copy.next_clip++};
}

std::uint64_t write_new(const StoreCopy& copy, const std::filesystem::path& out, const Job& job) {
  expect_store_name(out);
  NewFile fresh(out, Existing::kKept);
  const std::uint64_t bytes = write_copy(copy, fresh.descriptor(), out, job);
  fresh.commit();
  return bytes;
}

}  // namespace

FileSizes compacted_size(const std::filesystem::path& file) {
  const auto environment = Environment::open(file, Access::kRead);
  const Contents contents = read_contents(environment);
  return {environment->file_bytes(), write_copy(whole(contents), -1, file)};
}

FileSizes compact(const std::filesystem::path& file, const Job& job) {
  const Replaced store(file);
  return store.by(whole(store.contents()), job);
}

FileSizes remove_clips(const std::filesystem::path& file, std::span<const std::string> names,
                       const Rebuildable& index, const Job& job) {
  const Replaced store(file);
  StoreCopy copy = whole(store.contents());
  leave_out(copy, index);
  for (const std::string& name : names) {
    const auto named = [&](const StoreCopy::Clip& clip) {
      return store.contents().clips.at(clip.id).record.name == name;
    };
    if (std::erase_if(copy.clips, named) > 0) continue;
    std::string there;
    for (const auto& [id, clip] : store.contents().clips) there += "\n  " + clip.record.name;
    throw Error(ErrorKind::kNotFound, file.string(), "it holds no clip named \"" + name + "\"",
                "Nothing was removed. Its clips are:" + there);
  }
  return store.by(copy, job);
}

MergeReport merge(std::span<const std::filesystem::path> files, const std::filesystem::path& out,
                  const Rebuildable& index, const Job& job, std::span<const std::string> order) {
  std::vector<Contents> stores;
  for (const std::filesystem::path& named : files)
    for (const std::filesystem::path& file : stores_named(named))
      stores.push_back(read_contents(Environment::open(file, Access::kRead)));
  MergeReport report;
  StoreCopy copy{.store_id = draw_store_id(), .settings = stores.front().settings};
  leave_out(copy, index);
  choose_clips(stores, order, copy, report);
  for (const Contents& store : stores) {
    for (const auto& [name, blob] : store.blobs)
      if (!index.blobs.contains(name))
        throw Error(ErrorKind::kInput, store.file.string(),
                    "holds \"" + name + "\", which belongs to no clip and has no meaning in another store",
                    "Erase it first");
    report.index_left_out |= has_index(store, index);
  }
  report.clips = copy.clips.size();
  report.bytes = write_new(copy, out, job);
  return report;
}

RepairReport repair(const std::filesystem::path& file, const std::filesystem::path& out,
                    const Rebuildable& index, const Job& job) {
  expect_one_store(file);
  Salvage found = salvage(file, index, job);
  found.report.bytes = write_new(whole(found.contents), out, job);
  return std::move(found.report);
}

}  // namespace freshet::store
