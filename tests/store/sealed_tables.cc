#include "tests/store/sealed_tables.h"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <cstring>
#include <stdexcept>

#include "freshet/error.h"
#include "store/records/identity.h"
#include "store/records/record.h"
#include "store/rewrite/page_writer.h"

namespace freshet::store {

namespace {

const std::filesystem::path kName = "sealed";
constexpr std::size_t kMaxPayload = 64 << 20;

Bytes copy_of(ByteSpan bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

void SealedTables::put(Table in, const Bytes& key, Bytes value) {
  RecordHeader header;
  header.codec = static_cast<Codec>(static_cast<std::uint8_t>(value[4]) & 3);
  header.flags = static_cast<std::uint8_t>(value[5]);
  header.parameter = load<std::uint32_t>(&value[8]);
  header.raw_bytes = load<std::uint64_t>(&value[16]);
  header.total_bytes = load<std::uint64_t>(&value[24]);
  std::size_t hashed = value.size() - kRecordHeaderBytes;
  const std::size_t directory = std::size_t{header.parameter} * kTileEntryBytes;
  if (header.codec == Codec::kTiles && directory <= hashed) {
    std::size_t at = kRecordHeaderBytes + directory;
    for (std::size_t entry = kRecordHeaderBytes; entry < kRecordHeaderBytes + directory;
         entry += kTileEntryBytes) {
      const std::size_t bytes = std::min<std::size_t>(load<std::uint32_t>(&value[entry]), value.size() - at);
      const std::uint64_t hash = XXH3_64bits_withSeed(value.data() + at, bytes, id_);
      std::memcpy(&value[entry + 4], &hash, sizeof hash);
      at += bytes;
    }
    hashed = directory;
  }
  seal_record({kName, id_, in, key}, header, hashed, value);
  table(in).insert_or_assign(key, std::move(value));
}

std::optional<Bytes> SealedTables::payload(Table in, const Bytes& key) const {
  const Records& records = tables_[static_cast<std::size_t>(in)];
  const auto found = records.find(key);
  if (found == records.end()) return std::nullopt;
  try {
    return decode_record({kName, id_, in, key}, found->second, kMaxPayload);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void SealedTables::put_payload(Table in, const Bytes& key, ByteSpan payload) {
  table(in).insert_or_assign(key, encode_record({kName, id_, in, key}, payload, 1, payload.size()));
}

std::string SealedTables::settings() const {
  const Bytes json = payload(Table::kMeta, copy_of(bytes_of(kSettingsKey))).value_or(Bytes{});
  return {reinterpret_cast<const char*>(json.data()), json.size()};
}

void SealedTables::set_settings(const std::string& json) {
  put_payload(Table::kMeta, copy_of(bytes_of(kSettingsKey)), bytes_of(json));
}

std::map<ClipId, StoredClip> SealedTables::clips() const {
  std::map<ClipId, StoredClip> found;
  for (const auto& [key, value] : tables_[static_cast<std::size_t>(Table::kClips)]) {
    const auto bytes = payload(Table::kClips, key);
    if (auto clip = bytes ? parse_clip(*bytes) : std::nullopt)
      found.emplace(ClipId{load_big_endian(key.data())}, *std::move(clip));
  }
  return found;
}

void SealedTables::set_clip(ClipId id, const StoredClip& clip) {
  put_payload(Table::kClips, clip_key(id), serialise_clip(clip));
}

Bytes SealedTables::array(Table in, const Bytes& prefix) const {
  Bytes all;
  const Records& records = tables_[static_cast<std::size_t>(in)];
  for (auto r = records.lower_bound(prefix); r != records.end(); ++r) {
    if (r->first.size() < prefix.size() || !std::equal(prefix.begin(), prefix.end(), r->first.begin())) break;
    const Bytes chunk = payload(in, r->first).value_or(Bytes{});
    all.insert(all.end(), chunk.begin(), chunk.end());
  }
  return all;
}

ArrayAccount SealedTables::set_array(Table in, const Bytes& prefix, ByteSpan bytes,
                                     std::uint32_t element_bytes, std::uint8_t flags) {
  std::erase_if(table(in), [&](const auto& record) {
    return record.first.size() >= prefix.size() &&
           std::equal(prefix.begin(), prefix.end(), record.first.begin());
  });
  ArrayAccount account{element_bytes, flags, bytes.size(), {}};
  const std::size_t step = kChunkBytes / element_bytes * element_bytes;
  for (std::uint32_t chunk = 0; chunk < chunks_of(account); ++chunk) {
    Bytes key = prefix;
    append(key, __builtin_bswap32(chunk));
    const ByteSpan part = bytes.subspan(chunk * step, std::min(step, bytes.size() - chunk * step));
    table(in).insert_or_assign(
        key, encode_record({kName, id_, in, key}, part, element_bytes, bytes.size(), flags));
  }
  account.sum = sum_of(in, prefix);  // an account without the right number of records cannot be read
  return account;
}

void SealedTables::set_column(ClipId id, StoredClip& clip, const std::string& name,
                              const std::optional<Bytes>& bytes, std::uint32_t element_bytes) {
  const ArrayAccount account = set_array(Table::kColumns, column_prefix(id, name),
                                         bytes ? ByteSpan(*bytes) : ByteSpan(), element_bytes, 0);
  if (bytes)
    clip.columns[name] = account;
  else
    clip.columns.erase(name);
}

void SealedTables::set_blob(const std::string& name, ByteSpan bytes, std::uint32_t element_bytes,
                            std::uint8_t flags) {
  StoreAccount all = account();
  all.blobs[name] = set_array(Table::kBlobs, blob_prefix(name), bytes, element_bytes, flags);
  put_payload(Table::kMeta, copy_of(bytes_of(kAccountKey)), serialise_account(all));
}

RecordSum SealedTables::sum_of(Table in, const Bytes& prefix) const {
  const Records& records = tables_[static_cast<std::size_t>(in)];
  RecordSum sum;
  for (auto r = records.lower_bound(prefix); r != records.end(); ++r) {
    if (r->first.size() < prefix.size() || !std::equal(prefix.begin(), prefix.end(), r->first.begin())) break;
    sum.add(r->second);
  }
  return sum;
}

StoreAccount SealedTables::account() const {
  const auto bytes = payload(Table::kMeta, copy_of(bytes_of(kAccountKey)));
  return (bytes ? parse_account(*bytes) : std::nullopt).value_or(StoreAccount{});
}

void SealedTables::add_up() {
  for (auto& [id, clip] : clips()) {
    StoredClip summed = clip;
    for (std::size_t s = 0; s < kStreams; ++s) {
      Bytes prefix = tile_key(id, static_cast<Stream>(s), 0);
      prefix.resize(5);
      summed.tiles[s] = sum_of(Table::kTiles, prefix);
    }
    for (auto& [name, column] : summed.columns) column.sum = sum_of(Table::kColumns, column_prefix(id, name));
    set_clip(id, summed);
  }
  StoreAccount all = account();
  all.clips = sum_of(Table::kClips, {});
  for (auto& [name, blob] : all.blobs) blob.sum = sum_of(Table::kBlobs, blob_prefix(name));
  put_payload(Table::kMeta, copy_of(bytes_of(kAccountKey)), serialise_account(all));
  table(Table::kMeta).insert_or_assign(copy_of(bytes_of(kIdentityKey)), encode_identity(id_));
}

void SealedTables::write(const std::filesystem::path& file) {
  add_up();
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0600);
  if (fd < 0) throw std::runtime_error(file.string() + " cannot be written");
  PageWriter pages(fd, file);
  for (const Table t : {Table::kTiles, Table::kColumns, Table::kBlobs, Table::kClips, Table::kMeta}) {
    pages.begin_table(kTableNames[static_cast<std::size_t>(t)]);
    for (const auto& [key, value] : table(t)) pages.add(key, value);
  }
  pages.finish();
  ::close(fd);
}

}  // namespace freshet::store
