// A store of any records, all of whose hashes and sums are right: whoever makes a store computes them. The entries of the
// bytes are sealed again and written as a new file, which is then read, as the table of patches too; or refused.

#include <algorithm>
#include <cstring>

#include "store/records/account.h"
#include "store/records/clip_record.h"
#include "store/records/identity.h"
#include "store/records/record.h"
#include "store/rewrite/page_writer.h"
#include "store/rewrite/record_scan.h"
#include "store/store.h"
#include "stored/patch_table.h"
#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

using namespace freshet;
using namespace freshet::store;

namespace {

constexpr std::uint64_t kStoreId = 5;
const std::filesystem::path kName = "fuzzed";

struct ByKey {
  bool operator()(const Bytes& a, const Bytes& b) const { return std::ranges::lexicographical_compare(a, b); }
};
using Records = std::map<Bytes, Bytes, ByKey>;  // values by their keys

/// Gives a record's header, and the directory of tiles, the hashes of what they are of.
void seal(Table table, const Bytes& key, Bytes& value) {
  RecordHeader header;
  header.codec = static_cast<Codec>(static_cast<std::uint8_t>(value[4]) & 3);
  header.flags = static_cast<std::uint8_t>(value[5]);
  header.parameter = load<std::uint32_t>(&value[8]);
  header.raw_bytes = load<std::uint64_t>(&value[16]);
  header.total_bytes = load<std::uint64_t>(&value[24]);
  std::size_t hashed = value.size() - kRecordHeaderBytes;
  if (header.codec == Codec::kTiles) {
    const std::size_t directory = std::size_t{header.parameter} * kTileEntryBytes;
    if (directory <= hashed) {
      std::size_t at = kRecordHeaderBytes + directory;
      for (std::size_t entry = kRecordHeaderBytes; entry < kRecordHeaderBytes + directory;
           entry += kTileEntryBytes) {
        const std::size_t bytes =
            std::min<std::size_t>(load<std::uint32_t>(&value[entry]), value.size() - at);
        const std::uint64_t hash = XXH3_64bits_withSeed(value.data() + at, bytes, kStoreId);
        std::memcpy(&value[entry + 4], &hash, sizeof hash);
        at += bytes;
      }
      hashed = directory;
    }
  }
  seal_record({kName, kStoreId, table, key}, header, hashed, value);
}

RecordSum sum_of(const Records& records, const Bytes& prefix) {
  RecordSum sum;
  for (auto r = records.lower_bound(prefix); r != records.end(); ++r) {
    if (r->first.size() < prefix.size() || !std::equal(prefix.begin(), prefix.end(), r->first.begin())) break;
    sum.add(r->second);
  }
  return sum;
}

/// The payload of a record that is kept as it is; nothing of one that is compressed.
std::optional<Bytes> raw_payload(const Bytes& value) {
  if (value[4] != std::byte{0}) return std::nullopt;
  return Bytes(value.begin() + kRecordHeaderBytes, value.end());
}

/// Takes the entries of a file apart, seals them, and gives every account the sums of what is there.
std::array<Records, kTables> sealed(const RecordScan& scan) {
  std::array<Records, kTables> tables;
  for (const RecordScan::Entry& entry : scan.entries) {
    if (!entry.live) continue;
    const Bytes key(entry.key.begin(), entry.key.end());
    const std::size_t size = key.size();
    const bool array = size >= 6 && key[size - 5] == std::byte{0};
    const bool meta =
        std::ranges::equal(key, bytes_of(kSettingsKey)) || std::ranges::equal(key, bytes_of(kAccountKey));
    const Table table = meta                              ? Table::kMeta
                        : size == 4                       ? Table::kClips
                        : size == kTileKeyBytes           ? Table::kTiles
                        : array && key[0] == std::byte{0} ? Table::kColumns  // of the first clips
                                                          : Table::kBlobs;
    Bytes value(entry.value.begin(), entry.value.end());
    seal(table, key, value);
    tables[static_cast<std::size_t>(table)].insert_or_assign(key, std::move(value));
  }
  const auto& [metas, clips, tiles, columns, blobs] = tables;
  for (auto& [key, value] : tables[static_cast<std::size_t>(Table::kClips)]) {
    const auto raw = raw_payload(value);
    auto clip = raw ? parse_clip(*raw) : std::nullopt;
    if (!clip) continue;
    const ClipId id{load_big_endian(key.data())};
    for (std::size_t s = 0; s < kStreams; ++s) {
      Bytes prefix = tile_key(id, static_cast<Stream>(s), 0);
      prefix.resize(5);
      clip->tiles[s] = sum_of(tiles, prefix);
    }
    for (auto& [name, column] : clip->columns) column.sum = sum_of(columns, column_prefix(id, name));
    const Bytes bytes = serialise_clip(*clip);
    value.resize(kRecordHeaderBytes);
    value.insert(value.end(), bytes.begin(), bytes.end());
    const std::uint64_t size = bytes.size();
    std::memcpy(&value[16], &size, sizeof size);
    seal(Table::kClips, key, value);
  }
  StoreAccount account;
  const Bytes account_key(bytes_of(kAccountKey).begin(), bytes_of(kAccountKey).end());
  if (const auto there = metas.find(account_key); there != metas.end())
    if (const auto raw = raw_payload(there->second))
      if (const auto parsed = parse_account(*raw)) account = *parsed;
  account.clips = sum_of(clips, {});
  for (auto& [name, blob] : account.blobs) blob.sum = sum_of(blobs, blob_prefix(name));
  const Bytes bytes = serialise_account(account);
  tables[0][account_key] =
      encode_record({kName, kStoreId, Table::kMeta, account_key}, bytes, 1, bytes.size());
  const ByteSpan identity_key = bytes_of(kIdentityKey);
  tables[0][Bytes(identity_key.begin(), identity_key.end())] = encode_identity(kStoreId);
  return tables;
}

void write_store(const std::array<Records, kTables>& tables, const std::filesystem::path& file) {
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
  fuzz::expect(fd >= 0, "the store could be written to the temporary folder");
  PageWriter pages(fd, file);
  for (const std::size_t t : {2u, 3u, 4u, 1u, 0u}) {
    pages.begin_table(kTableNames[t]);
    for (const auto& [key, value] : tables[t]) pages.add(key, value);
  }
  pages.finish();
  ::close(fd);
}

void read_all(const std::filesystem::path& file) {
  const Store opened = Store::open_read(file);
  const Snapshot snapshot = opened.snapshot();
  fuzz::allow_errors([&] { snapshot.verify(); });
  fuzz::allow_errors([&] { snapshot.digest(); });
  fuzz::allow_errors([&] { snapshot.usage(); });
  fuzz::allow_errors([&] { stored::read_patch_table(snapshot); });
  fuzz::allow_errors([&] {
    for (const std::string& name : snapshot.blob_names()) fuzz::allow_errors([&] { snapshot.blob(name); });
  });
  for (const ClipId id : snapshot.clips())
    fuzz::allow_errors([&] {
      const StreamShape& shape = snapshot.clip(id).frames;
      for (std::uint32_t p = 0; p < shape.planes.size(); ++p) {
        const PlaneShape& plane = shape.planes[p];
        std::vector<std::byte> out(std::size_t{plane.width} * plane.bytes_per_sample);
        if (shape.frames > 0)
          fuzz::allow_errors([&] {
            snapshot.read(id, Stream::kFrames, p, {0, 0, plane.width, 1}, 0, 1, out);
          });
      }
    });
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const fuzz::InputFile file({bytes, size}, ".freshet");
  const std::filesystem::path made = file.path().string() + ".sealed";
  fuzz::allow_errors([&] {
    write_store(sealed(scan_records(file.path(), {})), made);
    read_all(made);
  });
  std::error_code ignored;
  std::filesystem::remove(made, ignored);
  std::filesystem::remove(made.string() + "-lock", ignored);
  return 0;
}
