#include <algorithm>
#include <set>
#include <utility>

#include "freshet/error.h"
#include "store/clip_union.h"
#include "store/codec/tile_codec.h"
#include "store/records/tile_record.h"
#include "store/store_impl.h"

namespace freshet::store {
namespace {

constexpr std::size_t kMaxSettingsBytes = 64 << 20;

[[noreturn]] void throw_usage(const char* what, const std::string& fault) {
  throw Error(ErrorKind::kUsage, what, fault);
}

// Copies what a tile and a region share.
void copy_overlap(const TileBox& box, const std::byte* samples, Rect region, std::uint32_t first,
                  std::uint32_t count, std::byte* out) {
  const std::size_t bytes = box.bytes_per_sample;
  const std::uint32_t x0 = std::max(box.x, region.x),
                      x1 = std::min(box.x + box.width, region.x + region.width);
  const std::uint32_t y0 = std::max(box.y, region.y),
                      y1 = std::min(box.y + box.height, region.y + region.height);
  const std::uint32_t f0 = std::max(box.first_frame, first),
                      f1 = std::min(box.first_frame + box.frames, first + count);
  for (std::uint32_t f = f0; f < f1; ++f) {
    for (std::uint32_t y = y0; y < y1; ++y) {
      const std::size_t from =
          (std::size_t{f - box.first_frame} * box.height + (y - box.y)) * box.width + (x0 - box.x);
      const std::size_t to =
          (std::size_t{f - first} * region.height + (y - region.y)) * region.width + (x0 - region.x);
      std::memcpy(out + to * bytes, samples + from * bytes, (x1 - x0) * bytes);
    }
  }
}

}  // namespace

Snapshot::Impl::Impl(std::shared_ptr<Environment> environment) : txn(std::move(environment)) {
  const RecordPlace at = txn.place(Table::kMeta, bytes_of("settings"));
  const auto value = txn.get(Table::kMeta, at.key);
  if (!value) throw_damaged(at, "the record is missing");
  const Bytes text = decode_record(at, *value, kMaxSettingsBytes);
  settings.assign(reinterpret_cast<const char*>(text.data()), text.size());

  const RecordPlace account_at = txn.place(Table::kMeta, bytes_of(kAccountKey));
  try {
    const auto bytes = txn.get(Table::kMeta, account_at.key);
    if (!bytes) throw_damaged(account_at, "the record is missing");
    account = parse_account(decode_record(account_at, *bytes, kMaxAccountBytes));
    if (!account) throw_damaged(account_at, "the store's account of its records is garbled");
  } catch (const Error& error) {
    account_fault = error.what();
  }

  RecordSum found;
  for (const auto& [key, bytes] : txn.entries(Table::kClips)) {
    found.add(bytes);
    const RecordPlace place = txn.place(Table::kClips, key);
    if (key.size() != 4) throw_damaged(place, "the clip's key is garbled");
    const ClipId id{load_big_endian(key.data())};
    clips.push_back(id);
    try {
      auto clip = parse_clip(decode_record(place, bytes, kMaxClipRecordBytes));
      if (!clip) throw_damaged(place, "the clip's record is garbled");
      by_name.emplace(clip->record.name, id);
      by_source.emplace(clip->record.source_hash, id);
      records.emplace(id, std::move(*clip));
    } catch (const Error& error) {
      damaged.emplace(id, error.what());
    }
  }
  if (account && (found != account->clips ||
                  (!clips.empty() && static_cast<std::uint32_t>(clips.back()) >= account->next_clip))) {
    try {
      throw_damaged(account_at, "the store has written " + std::to_string(account->clips.records) +
                                    " clips, and " + std::to_string(found.records) + " are there" +
                                    (found.records == account->clips.records ? ", not the same" : ""));
    } catch (const Error& error) {
      account_fault = error.what();
    }
  }
}

const StoredClip& Snapshot::Impl::stored(ClipId id) const {
  if (const auto found = records.find(id); found != records.end()) return found->second;
  const Bytes key = clip_key(id);
  if (damaged.contains(id)) throw_damaged(txn.place(Table::kClips, key), "the clip's record cannot be read");
  throw Error(ErrorKind::kNotFound, txn.environment().file().string(),
              "has no clip " + std::to_string(static_cast<std::uint32_t>(id)));
}

const StoreAccount& Snapshot::Impl::accounted() const {
  if (!account) throw_damaged(txn.place(Table::kMeta, bytes_of(kAccountKey)), "the record cannot be read");
  return *account;
}

void Snapshot::Impl::expect_whole() const {
  if (!account_fault.empty())
    throw_damaged(txn.place(Table::kMeta, bytes_of(kAccountKey)),
                  "the clips are not those that were written");
  if (damaged.empty()) return;
  const Bytes key = clip_key(damaged.begin()->first);
  throw_damaged(txn.place(Table::kClips, key), "the clip's record cannot be read");
}

void Snapshot::Impl::read(ClipId id, Stream stream, std::uint32_t plane, Rect region, std::uint32_t first,
                          std::uint32_t count, std::span<std::byte> out) const {
  const TileGrid& tiles = grid(id, stream);
  Bytes samples, key;
  TileRecord record;
  std::uint32_t record_first = 0;
  for (const std::uint32_t tile : tiles.touched(plane, region, first, count)) {
    if (tile - record_first >= record.count()) {
      const Bytes wanted = tile_key(id, stream, tile);
      const auto entry = txn.floor(Table::kTiles, wanted);
      if (!entry || entry->key.size() != kTileKeyBytes ||
          !std::equal(wanted.begin(), wanted.begin() + 5, entry->key.begin())) {
        throw_damaged(txn.place(Table::kTiles, wanted), "the record is missing");
      }
      key = Bytes(entry->key.begin(), entry->key.end());
      record = TileRecord(txn.place(Table::kTiles, key), entry->value);
      record_first = load_big_endian(key.data() + 5);
      if (tile - record_first >= record.count())
        throw_damaged(txn.place(Table::kTiles, wanted), "the record is missing");
    }
    const RecordPlace place = txn.place(Table::kTiles, key);
    const TileBox box = tiles.box(tile);
    samples.resize(box.bytes());
    if (!decode_tile(box, record.tile(place, tile - record_first), samples)) {
      throw_damaged(place, "tile " + std::to_string(tile) + " does not decode");
    }
    copy_overlap(box, samples.data(), region, first, count, out.data());
  }
}

Snapshot::Impl::Chunks Snapshot::Impl::chunks(Table table, ByteSpan prefix,
                                              const ArrayAccount& account_of) const {
  Chunks found;
  found.entries = txn.entries(table, prefix);
  if (found.entries.empty()) throw_damaged(txn.place(table, prefix), "the record is missing");
  found.total_bytes = account_of.bytes;
  found.element_bytes = account_of.element_bytes;
  found.flags = account_of.flags;
  std::uint64_t bytes = 0;
  RecordSum sum;
  for (std::size_t i = 0; i < found.entries.size(); ++i) {
    const auto& [key, value] = found.entries[i];
    const RecordPlace place = txn.place(table, key);
    const RecordHeader header = open_record(place, value).header;
    if (key.size() != prefix.size() + 4 || load_big_endian(key.data() + prefix.size()) != i) {
      throw_damaged(place, "the chunk before it is missing");
    }
    if (header.total_bytes != found.total_bytes || header.parameter != found.element_bytes ||
        header.flags != found.flags || header.raw_bytes > kChunkBytes ||
        header.raw_bytes > found.total_bytes - bytes) {
      throw_damaged(place, "the chunk is not of the array that was written");
    }
    bytes += header.raw_bytes;
    sum.add(value);
  }
  if (bytes != found.total_bytes || sum != account_of.sum) {
    throw_damaged(txn.place(table, found.entries.back().key),
                  bytes != found.total_bytes ? "the chunks after it are missing"
                                             : "the chunks are not those that were written last");
  }
  return found;
}

void Snapshot::Impl::decode_chunks(Table table, const Chunks& chunks, std::span<std::byte> out) const {
  for (const auto& [key, value] : chunks.entries) {
    const RecordPlace place = txn.place(table, key);
    const Record record = open_record(place, value);
    decode_record(place, record, out.first(record.header.raw_bytes));
    out = out.subspan(record.header.raw_bytes);
  }
}

Snapshot::Joined::Joined(std::filesystem::path list,
                         const std::vector<std::shared_ptr<Environment>>& environments)
    : path(std::move(list)) {
  ClipUnion all;
  for (const std::shared_ptr<Environment>& environment : environments) {
    const Impl& file = *files.emplace_back(std::make_shared<const Impl>(environment));
    all.expect_settings(environment->file(), file.settings);
    for (const ClipId id : file.clips) {
      const auto stored =
          file.records.find(id);  // a damaged one keeps its place, and says so when it is read
      if (stored != file.records.end() && all.add(environment->file(), stored->second.record) != nullptr)
        continue;
      const auto as = ClipId{static_cast<std::uint32_t>(clips.size())};
      clips.push_back(as);
      places.push_back({files.size() - 1, id});
      if (stored == file.records.end()) continue;
      by_name.emplace(stored->second.record.name, as);
      by_source.emplace(stored->second.record.source_hash, as);
    }
  }
}

Snapshot::Place Snapshot::place(ClipId id) const {
  if (joined_ == nullptr) return {*impl_, id};
  const auto number = static_cast<std::size_t>(id);
  if (number >= joined_->places.size())
    throw Error(ErrorKind::kNotFound, joined_->path.string(), "has no clip " + std::to_string(number));
  const Joined::Clip& clip = joined_->places[number];
  return {*joined_->files[clip.file], clip.id};
}

const std::filesystem::path& Snapshot::path() const {
  return joined_ != nullptr ? joined_->path : impl_->txn.environment().file();
}

std::vector<std::filesystem::path> Snapshot::files() const {
  std::vector<std::filesystem::path> names;
  for (const Impl* file : each_file()) names.push_back(file->txn.environment().file());
  return names;
}

const std::filesystem::path& Snapshot::file_of(ClipId id) const {
  return place(id).file.txn.environment().file();
}

const std::string& Snapshot::settings() const { return each_file().front()->settings; }
std::span<const ClipId> Snapshot::clips() const { return joined_ != nullptr ? joined_->clips : impl_->clips; }
const ClipRecord& Snapshot::clip(ClipId id) const {
  const Place at = place(id);
  return at.file.stored(at.id).record;
}

std::optional<ClipId> Snapshot::find(std::string_view name) const {
  const auto& clips = joined_ != nullptr ? joined_->by_name : impl_->by_name;
  if (const auto found = clips.find(name); found != clips.end()) return found->second;
  expect_whole();
  return std::nullopt;
}

std::optional<ClipId> Snapshot::find_source(std::string_view source_hash) const {
  const auto& clips = joined_ != nullptr ? joined_->by_source : impl_->by_source;
  if (const auto found = clips.find(source_hash); found != clips.end()) return found->second;
  expect_whole();
  return std::nullopt;
}

void Snapshot::expect_whole() const {
  for (const Impl* file : each_file()) file->expect_whole();
}

void Snapshot::read(ClipId id, Stream stream, std::uint32_t plane, Rect region, std::uint32_t first,
                    std::uint32_t count, std::span<std::byte> out) const {
  if (static_cast<std::size_t>(stream) >= kStreams) throw_usage("Snapshot::read", "there is no such stream");
  const auto [file, own] = place(id);
  const StreamShape& shape = file.grid(own, stream).shape();
  if (plane >= shape.planes.size()) {
    throw Error(
        ErrorKind::kNotFound, file.stored(own).record.name,
        "has no plane " + std::to_string(plane) + " in stream " + std::to_string(static_cast<int>(stream)));
  }
  const PlaneShape& size = shape.planes[plane];
  if (region.x > size.width || region.width > size.width - region.x || region.y > size.height ||
      region.height > size.height - region.y || first > shape.frames || count > shape.frames - first) {
    throw_usage("Snapshot::read", "the region leaves the plane or the frames of the clip");
  }
  if (out.size() != std::size_t{region.width} * region.height * count * size.bytes_per_sample) {
    throw_usage("Snapshot::read", "out has not the size of the region");
  }
  file.read(own, stream, plane, region, first, count, out);
}

bool Snapshot::has_column(ClipId id, std::string_view name) const {
  const Place at = place(id);
  return at.file.stored(at.id).columns.contains(name);
}

void Snapshot::prefetch_column(ClipId id, std::string_view name) const {
  const Place at = place(id);
  at.file.txn.prefetch(Table::kColumns, column_prefix(at.id, name));
}

const ArrayAccount& Snapshot::Impl::column(ClipId id, std::string_view name) const {
  const StoredClip& clip = stored(id);
  const auto column = clip.columns.find(name);
  if (column == clip.columns.end()) {
    throw Error(ErrorKind::kNotFound, clip.record.name, "has no column \"" + std::string(name) + "\"",
                "Ingest the clip again with this version of Freshet");
  }
  return column->second;
}

std::uint64_t Snapshot::column_rows(ClipId id, std::string_view name) const {
  const auto [file, own] = place(id);
  const ArrayAccount& account = file.column(own, name);
  if (account.element_bytes == 0) return 0;
  return file.chunks(Table::kColumns, column_prefix(own, name), account).total_bytes / account.element_bytes;
}

std::uint32_t Snapshot::column_element(ClipId id, std::string_view name) const {
  const auto [file, own] = place(id);
  return file.column(own, name).element_bytes;
}

void Snapshot::column_into(ClipId id, std::string_view name, std::uint32_t element_size,
                           std::span<std::byte> (*resize)(void*, std::size_t), void* context) const {
  const auto [file, own] = place(id);
  const ArrayAccount& account = file.column(own, name);
  if (account.element_bytes != element_size || account.bytes % element_size != 0) {
    throw_usage("Snapshot::column", "column \"" + std::string(name) + "\" has elements of " +
                                        std::to_string(account.element_bytes) + " bytes, asked for " +
                                        std::to_string(element_size));
  }
  const Bytes prefix = column_prefix(own, name);
  const auto chunks = file.chunks(Table::kColumns, prefix, account);
  file.decode_chunks(Table::kColumns, chunks, resize(context, chunks.total_bytes / element_size));
}

Bytes Snapshot::Impl::array(Table table, ByteSpan prefix, const ArrayAccount& account_of) const {
  const Chunks parts = chunks(table, prefix, account_of);
  Bytes bytes(parts.total_bytes);
  decode_chunks(table, parts, bytes);
  return bytes;
}

std::optional<Bytes> Snapshot::Impl::blob(std::string_view name) const {
  const ArrayAccounts& blobs = accounted().blobs;
  const auto account_of = blobs.find(name);
  if (account_of == blobs.end()) return std::nullopt;
  return array(Table::kBlobs, blob_prefix(name), account_of->second);
}

std::optional<std::vector<std::byte>> Snapshot::blob(std::string_view name) const {
  if (joined_ == nullptr) return impl_->blob(name);
  std::optional<Bytes> bytes = joined_->files.front()->blob(name);
  for (std::size_t i = 1; bytes && i < joined_->files.size(); ++i)
    if (joined_->files[i]->blob(name) != bytes) bytes.reset();
  return bytes;
}

std::vector<std::string> Snapshot::blob_names() const {
  std::set<std::string> names;
  for (const Impl* file : each_file())
    for (const auto& [name, account] : file->accounted().blobs) names.insert(name);
  return {names.begin(), names.end()};
}

std::vector<const Snapshot::Impl*> Snapshot::each_file() const {
  if (joined_ == nullptr) return {impl_.get()};
  std::vector<const Impl*> files;
  for (const auto& file : joined_->files) files.push_back(file.get());
  return files;
}

}  // namespace freshet::store
