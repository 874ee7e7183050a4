#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

#include "freshet/error.h"
#include "store/codec/tile_codec.h"
#include "store/records/column.h"
#include "store/records/tile_record.h"
#include "store/store_impl.h"

namespace freshet::store {
namespace {

void check_name(std::string_view name, std::size_t longest) {
  if (!name_fits(name, longest)) {
    throw Error(
        ErrorKind::kUsage, "name \"" + std::string(name) + "\"",
        "a column's or blob's name has 1 to " + std::to_string(longest) + " bytes, none of them zero");
  }
}

std::size_t chunk_bytes(std::uint32_t element_bytes) {
  return std::max<std::size_t>(kChunkBytes / element_bytes, 1) * element_bytes;
}

// Chunks of a long array are coded on all threads and put in order.
template <class KeyOf>
ArrayAccount put_chunks(WriteTransaction& txn, Table table, ByteSpan bytes, std::uint32_t element_bytes,
                        std::uint8_t flags, KeyOf key_of) {
  const std::size_t step = chunk_bytes(element_bytes);
  const std::size_t count = std::max<std::size_t>((bytes.size() + step - 1) / step, 1);
  constexpr std::size_t kBatch = 32;  // chunks in memory at once
  ArrayAccount account{.element_bytes = element_bytes, .flags = flags, .bytes = bytes.size(), .sum = {}};
  for (std::size_t first = 0; first < count; first += kBatch) {
    std::array<Bytes, kBatch> keys, values;
    const std::size_t batch = std::min(kBatch, count - first);
    tbb::parallel_for(std::size_t{0}, batch, [&](std::size_t i) {
      const std::size_t start = (first + i) * step;
      keys[i] = key_of(static_cast<std::uint32_t>(first + i));
      values[i] =
          encode_record(txn.place(table, keys[i]), bytes.subspan(start, std::min(step, bytes.size() - start)),
                        element_bytes, bytes.size(), flags);
    });
    for (std::size_t i = 0; i < batch; ++i) {
      txn.put(table, keys[i], values[i]);
      account.sum.add(values[i]);
    }
  }
  return account;
}

ArrayAccount put_column(WriteTransaction& txn, ClipId clip, std::string_view name, ByteSpan bytes,
                        std::uint32_t element_size) {
  return put_chunks(txn, Table::kColumns, bytes, element_size, 0,
                    [&](std::uint32_t chunk) { return column_key(clip, name, chunk); });
}

Bytes encode_clip(const WriteTransaction& txn, ByteSpan key, const StoredClip& clip) {
  const Bytes bytes = serialise_clip(clip);
  return encode_record(txn.place(Table::kClips, key), bytes, 1, bytes.size());
}

StoredClip decode_clip(const WriteTransaction& txn, ByteSpan key, ByteSpan value) {
  const RecordPlace at = txn.place(Table::kClips, key);
  auto clip = parse_clip(decode_record(at, value, kMaxClipRecordBytes));
  if (!clip) throw_damaged(at, "the clip's record is garbled");
  return std::move(*clip);
}

std::uint64_t column_rows(std::string_view name, std::size_t bytes, std::uint32_t element_size) {
  check_name(name, kMaxColumnName);
  if (element_size == 0 || element_size > kChunkBytes || bytes % element_size != 0) {
    throw Error(
        ErrorKind::kUsage, "column \"" + std::string(name) + "\"",
        std::to_string(bytes) + " bytes are no whole number of elements of " + std::to_string(element_size));
  }
  return bytes / element_size;
}

[[noreturn]] void throw_no_clip(ClipId id) {
  throw Error(ErrorKind::kNotFound, "clip " + std::to_string(static_cast<std::uint32_t>(id)),
              "is not in the store");
}

}  // namespace

struct ClipWriter::Impl {
  struct StreamState {
    bool begun = false;
    TileGrid grid;                       // grows frame by frame
    std::array<Bytes, kMaxPlanes> slab;  // frames of the slab in hand, packed, frame-major
    std::uint32_t slab_frames = 0, next_tile = 0;
    TileRecordBuilder record;
    RecordSum written;
  };

  explicit Impl(const std::shared_ptr<Environment>& environment)
      : txn(environment), account(read_account(txn)), clip{account.next_clip} {}

  void take_frame(StreamState& state, std::span<const PlaneView> planes) {
    const auto& shapes = state.grid.shape().planes;
    for (std::size_t p = 0; p < shapes.size(); ++p) {
      const std::size_t row_bytes = std::size_t{shapes[p].width} * shapes[p].bytes_per_sample;
      const std::size_t frame_bytes = row_bytes * shapes[p].height;
      state.slab[p].resize(kSlabFrames * frame_bytes);
      std::byte* to = state.slab[p].data() + state.slab_frames * frame_bytes;
      for (std::uint32_t y = 0; y < shapes[p].height; ++y) {
        std::memcpy(to + y * row_bytes, planes[p].data + static_cast<std::ptrdiff_t>(y) * planes[p].stride,
                    row_bytes);
      }
    }
    ++state.slab_frames;
  }

  void code_slab(Stream stream, StreamState& state) {
    if (state.slab_frames == 0) return;
    StreamShape shape = state.grid.shape();
    shape.frames += state.slab_frames;
    state.grid = TileGrid(shape, state.grid.edges_log2());
    const std::uint32_t first = state.next_tile, count = state.grid.tiles_per_slab();
    std::vector<Bytes> coded(count);
    tbb::parallel_for(std::uint32_t{0}, count, [&](std::uint32_t i) {
      thread_local Bytes samples;
      const TileBox box = state.grid.box(first + i);
      const std::size_t pitch = std::size_t{shape.planes[box.plane].width} * box.bytes_per_sample;
      const std::size_t row_bytes = std::size_t{box.width} * box.bytes_per_sample;
      samples.resize(box.bytes());
      std::byte* to = samples.data();
      for (std::uint32_t f = 0; f < box.frames; ++f) {
        const std::byte* from = state.slab[box.plane].data() +
                                (std::size_t{f} * shape.planes[box.plane].height + box.y) * pitch +
                                std::size_t{box.x} * box.bytes_per_sample;
        for (std::uint32_t y = 0; y < box.height; ++y, to += row_bytes, from += pitch)
          std::memcpy(to, from, row_bytes);
      }
      encode_tile(box, samples, coded[i]);
    });
    for (const Bytes& tile : coded) {
      state.record.add(tile, state.grid.box(state.next_tile).bytes());
      ++state.next_tile;
      if (state.record.full()) put_record(stream, state);
    }
    state.slab_frames = 0;
  }

  void put_record(Stream stream, StreamState& state) {
    if (state.record.count() == 0) return;
    const Bytes key = tile_key(clip, stream, state.next_tile - state.record.count());
    const Bytes value = state.record.take(txn.place(Table::kTiles, key));
    txn.put(Table::kTiles, key, value);
    state.written.add(value);
  }

  /// The clips of the state that this transaction began with; read where the last commit was not ours.
  KnownClips& known_clips() {
    KnownClips& known = txn.known_clips();
    if (known.transaction + 1 == txn.number()) return known;
    known = {};
    txn.each(Table::kClips, [&](ByteSpan key, ByteSpan value) {
      StoredClip other = decode_clip(txn, key, value);
      known.named_by_source.emplace(other.record.source_hash, other.record.name);
      known.names.insert(std::move(other.record.name));
    });
    known.transaction = txn.number() - 1;
    return known;
  }

  void check_unique(const ClipRecord& record) {
    const KnownClips& known = known_clips();
    const auto same_source = known.named_by_source.find(record.source_hash);
    if (same_source == known.named_by_source.end() && !known.names.contains(record.name)) return;
    throw Error(ErrorKind::kInput, record.name,
                "the store has this clip already, as \"" +
                    (same_source == known.named_by_source.end() ? record.name : same_source->second) + "\"",
                "Leave it out, or give it another name if its content differs");
  }

  /// Before the commit: should it fail, the number is that of no state, and all is read again.
  void remember(const ClipRecord& record) {
    KnownClips& known = txn.known_clips();
    known.named_by_source.emplace(record.source_hash, record.name);
    known.names.insert(record.name);
    known.transaction = txn.number();
  }

  WriteTransaction txn;
  StoreAccount account;
  ClipId clip;
  ArrayAccounts columns;
  std::array<StreamState, kStreams> streams;
  std::optional<std::uint64_t> rows;
};

ClipWriter::ClipWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ClipWriter::ClipWriter(ClipWriter&&) noexcept = default;
ClipWriter::~ClipWriter() = default;

ClipWriter Store::add_clip() { return ClipWriter(std::make_unique<ClipWriter::Impl>(impl_->only_file())); }

void ClipWriter::begin_stream(Stream stream, std::span<const PlaneShape> planes) {
  Impl::StreamState& state = impl_->streams.at(static_cast<std::size_t>(stream));
  if (state.begun) throw Error(ErrorKind::kUsage, "begin_stream", "the stream has been declared already");
  if (planes.empty()) throw Error(ErrorKind::kUsage, "begin_stream", "a stream has at least one plane");
  state.grid = TileGrid({{planes.begin(), planes.end()}, 0}, TileGrid::default_edges(planes));
  state.begun = true;
}

void ClipWriter::append(Stream stream, std::span<const PlaneView> planes_of_frames) {
  Impl::StreamState& state = impl_->streams.at(static_cast<std::size_t>(stream));
  const std::size_t planes = state.grid.shape().planes.size();
  if (!state.begun || planes_of_frames.size() % planes != 0) {
    throw Error(ErrorKind::kUsage, "append", "the stream has not been declared, or a frame lacks a plane");
  }
  for (std::size_t i = 0; i < planes_of_frames.size(); i += planes) {
    impl_->take_frame(state, planes_of_frames.subspan(i, planes));
    if (state.slab_frames == kSlabFrames) impl_->code_slab(stream, state);
  }
}

void ClipWriter::column_bytes(std::string_view name, std::span<const std::byte> bytes,
                              std::uint32_t element_size) {
  const std::uint64_t rows = column_rows(name, bytes.size(), element_size);
  if (impl_->columns.contains(name))
    throw Error(ErrorKind::kUsage, "column \"" + std::string(name) + "\"", "the clip has it already");
  if (name.starts_with("patch.")) {
    if (impl_->rows && *impl_->rows != rows) {
      throw Error(ErrorKind::kUsage, "column \"" + std::string(name) + "\"",
                  "has " + std::to_string(rows) + " rows, the clip's other columns have " +
                      std::to_string(*impl_->rows));
    }
    impl_->rows = rows;
  }
  impl_->columns.emplace(name, put_column(impl_->txn, impl_->clip, name, bytes, element_size));
}

ClipId ClipWriter::commit(ClipRecord record) {
  Impl& impl = *impl_;
  impl.check_unique(record);
  StoredClip clip;
  for (std::size_t s = 0; s < kStreams; ++s) {
    Impl::StreamState& state = impl.streams[s];
    impl.code_slab(static_cast<Stream>(s), state);
    impl.put_record(static_cast<Stream>(s), state);
    stream_shape(record, s) = state.begun ? state.grid.shape() : StreamShape{};
    clip.grids[s] = state.grid;
    clip.tiles[s] = state.written;
  }
  record.frame_count = record.frames.frames;
  record.rows = impl.rows.value_or(0);
  clip.record = std::move(record);
  clip.columns = std::move(impl.columns);
  const Bytes key = clip_key(impl.clip), value = encode_clip(impl.txn, key, clip);
  impl.txn.put(Table::kClips, key, value);
  impl.account.clips.add(value);
  ++impl.account.next_clip;
  put_account(impl.txn, impl.account);
  impl.remember(clip.record);
  impl.txn.commit();
  return impl.clip;
}

void Store::write(std::span<const Blob> blobs, std::span<const Column> columns,
                  std::span<const std::string> erased_blobs) {
  if (impl_->files.size() == 1) return Impl::write(impl_->files.front(), blobs, columns, erased_blobs);
  const Snapshot::Joined joined(impl_->path, impl_->files);
  std::vector<std::vector<Column>> of_file(impl_->files.size());
  for (const Column& column : columns) {
    const auto number = static_cast<std::size_t>(column.clip);
    if (number >= joined.places.size()) throw_no_clip(column.clip);
    const Snapshot::Joined::Clip& clip = joined.places[number];
    of_file[clip.file].push_back({clip.id, column.name, column.bytes, column.element_size});
  }
  for (std::size_t i = 0; i < of_file.size(); ++i)
    Impl::write(impl_->files[i], blobs, of_file[i], erased_blobs);
}

void Store::Impl::write(const std::shared_ptr<Environment>& file, std::span<const Blob> blobs,
                        std::span<const Column> columns, std::span<const std::string> erased_blobs) {
  WriteTransaction txn(file);
  StoreAccount account = read_account(txn);
  const auto erase_blob = [&](std::string_view name) {
    check_name(name, kMaxBlobName);
    const Bytes prefix = blob_prefix(name);
    txn.erase(Table::kBlobs, prefix);
    if (const auto found = account.blobs.find(name); found != account.blobs.end()) account.blobs.erase(found);
  };
  for (const std::string& name : erased_blobs) erase_blob(name);
  for (const Blob& blob : blobs) {
    erase_blob(blob.name);
    account.blobs.emplace(blob.name,
                          put_chunks(txn, Table::kBlobs, blob.bytes, 1, blob.in_digest ? 0 : kOutsideDigest,
                                     [&](std::uint32_t chunk) { return blob_key(blob.name, chunk); }));
  }
  std::map<ClipId, StoredClip> changed;
  for (const Column& column : columns) {
    column_rows(column.name, column.bytes.size(), column.element_size);
    if (!changed.contains(column.clip)) {
      const Bytes key = clip_key(column.clip);
      const auto value = txn.get(Table::kClips, key);
      if (!value) throw_no_clip(column.clip);
      changed.emplace(column.clip, decode_clip(txn, key, *value));
      account.clips.subtract(*value);
    }
    const Bytes prefix = column_prefix(column.clip, column.name);
    txn.erase(Table::kColumns, prefix);
    StoredClip& clip = changed.at(column.clip);
    const ArrayAccount& put = clip.columns[column.name] =
        put_column(txn, column.clip, column.name, column.bytes, column.element_size);
    if (column.name.starts_with(kPatchColumns) && !has_rows(put, clip.record.rows))
      throw Error(ErrorKind::kUsage, "column \"" + column.name + "\"",
                  "has not the " + std::to_string(clip.record.rows) + " rows of the clip's patches");
  }
  for (const auto& [id, clip] : changed) {
    const Bytes key = clip_key(id), value = encode_clip(txn, key, clip);
    txn.put(Table::kClips, key, value);
    account.clips.add(value);
  }
  put_account(txn, account);
  txn.commit();
}

}  // namespace freshet::store
