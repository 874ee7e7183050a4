#include <array>

#include "store/records/record.h"
#include "store/store_impl.h"

namespace freshet::store {
namespace {

// What LMDB spends on a value: a place in a page of keys, and whole pages for a value that does not fit
// there.
std::uint64_t bytes_on_disk(const ReadTransaction::Entry& entry) {
  constexpr std::uint64_t kPage = 4096, kPageHeader = 16, kNode = 10, kMaxInside = 2038;
  const std::uint64_t node = kNode + entry.key.size() + entry.value.size();
  if (node <= kMaxInside) return node;
  return kNode + entry.key.size() + 8 + (kPageHeader + entry.value.size() + kPage - 1) / kPage * kPage;
}

// The raw size that a record states; 0 where it cannot be read.
std::uint64_t stated_raw_bytes(ByteSpan value) {
  return value.size() < kRecordHeaderBytes ? 0 : load<std::uint64_t>(value.data() + 16);
}

}  // namespace

std::vector<Snapshot::Usage> Snapshot::Impl::usage() const {
  static constexpr const char* kNames[] = {"meta", "clips", "", "columns", "blobs"};
  std::vector<Usage> usage;
  const auto add = [](Usage& to, const ReadTransaction::Entry& entry) {
    ++to.records;
    to.stored_bytes += bytes_on_disk(entry);
    to.raw_bytes += stated_raw_bytes(entry.value);
  };
  std::array<Usage, kStreams> streams{Usage{"frames"}, Usage{"flow"}, Usage{"average"}};
  for (const auto& entry : txn.entries(Table::kTiles)) {
    const std::size_t stream =
        entry.key.size() == kTileKeyBytes ? static_cast<std::size_t>(entry.key[4]) : kStreams;
    if (stream < kStreams) add(streams[stream], entry);
  }
  usage.insert(usage.end(), streams.begin(), streams.end());
  for (const Table table : {Table::kColumns, Table::kBlobs, Table::kClips, Table::kMeta}) {
    Usage sum{kNames[static_cast<std::size_t>(table)]};
    for (const auto& entry : txn.entries(table)) add(sum, entry);
    usage.push_back(std::move(sum));
  }
  Usage file{"file"};
  for (const Usage& part : usage) {
    file.records += part.records;
    file.raw_bytes += part.raw_bytes;
  }
  file.stored_bytes = txn.environment().file_bytes();
  usage.push_back(std::move(file));
  return usage;
}

std::vector<Snapshot::Usage> Snapshot::usage() const {
  std::vector<Usage> all;
  for (const Impl* file : each_file()) {
    const std::vector<Usage> of_file = file->usage();
    if (all.empty()) all.resize(of_file.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
      all[i].what = of_file[i].what;
      all[i].records += of_file[i].records;
      all[i].stored_bytes += of_file[i].stored_bytes;
      all[i].raw_bytes += of_file[i].raw_bytes;
    }
  }
  return all;
}

}  // namespace freshet::store
