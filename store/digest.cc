// The digest: XXH3-128 of the logical content, defined in docs/format.md. It hashes what a reader gets, never
// what lies on disk, so it outlives other codecs, record sizes and versions of zstd.

#include <oneapi/tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "platform/text.h"
#include "store/store_impl.h"

namespace freshet::store {
namespace {

class Hasher {
 public:
  Hasher() : state_(XXH3_createState()) { XXH3_128bits_reset(state_.get()); }
  void bytes(ByteSpan span) { XXH3_128bits_update(state_.get(), span.data(), span.size()); }
  void number(std::uint64_t value) { XXH3_128bits_update(state_.get(), &value, sizeof value); }
  void text(std::string_view string) {
    number(string.size());
    bytes(bytes_of(string));
  }
  XXH128_canonical_t result() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    return canonical;
  }

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_;
};

ByteSpan as_bytes(const XXH128_canonical_t& hash) { return std::as_bytes(std::span(hash.digest)); }

}  // namespace

std::string Snapshot::digest() const {
  const Impl& impl = *impl_;
  impl.expect_whole();
  std::vector<ClipId> order = impl.clips;
  std::ranges::sort(order, {}, [&](ClipId id) {
    const ClipRecord& record = impl.stored(id).record;
    return std::tie(record.source_hash, record.name);
  });

  const auto hash_stream = [&](ClipId id, Stream stream, Hasher& hasher) {
    const StreamShape& shape = impl.grid(id, stream).shape();
    hasher.number(shape.planes.size());
    hasher.number(shape.frames);
    for (std::uint32_t p = 0; p < shape.planes.size(); ++p) {
      const PlaneShape& plane = shape.planes[p];
      hasher.number(plane.width);
      hasher.number(plane.height);
      hasher.number(plane.bytes_per_sample);
      Bytes slab;
      for (std::uint32_t f = 0; f < shape.frames; f += kSlabFrames) {
        const std::uint32_t count = std::min(kSlabFrames, shape.frames - f);
        slab.resize(std::size_t{plane.width} * plane.height * plane.bytes_per_sample * count);
        impl.read(id, stream, p, {0, 0, plane.width, plane.height}, f, count, slab);
        hasher.bytes(slab);
      }
    }
  };
  const auto hash_clip = [&](ClipId id) {
    const ClipRecord& record = impl.stored(id).record;
    Hasher hasher;
    for (const std::string* text : {&record.name, &record.class_name, &record.licence, &record.source_hash,
                                    &record.pixel_format, &record.metadata}) {
      hasher.text(*text);
    }
    hasher.number(record.width);
    hasher.number(record.height);
    hasher.number(record.frame_count);
    hasher.number(static_cast<std::uint64_t>(record.fps_num));
    hasher.number(static_cast<std::uint64_t>(record.fps_den));
    hasher.number(record.rows);
    for (std::size_t s = 0; s < kStreams; ++s) hash_stream(id, static_cast<Stream>(s), hasher);
    for (const std::string& name : impl.column_names(id)) {
      const Bytes prefix = column_prefix(id, name);
      const auto chunks = impl.chunks(Table::kColumns, prefix);
      Bytes bytes(chunks->total_bytes);
      impl.decode_chunks(Table::kColumns, *chunks, bytes);
      hasher.text(name);
      hasher.number(chunks->element_bytes);
      hasher.number(bytes.size());
      hasher.bytes(bytes);
    }
    return hasher.result();
  };

  std::vector<XXH128_canonical_t> clip_hashes(order.size());
  tbb::parallel_for(std::size_t{0}, order.size(),
                    [&](std::size_t i) { clip_hashes[i] = hash_clip(order[i]); });

  Hasher whole;
  whole.text("freshet digest 1");
  whole.text(impl.settings);
  whole.number(order.size());
  for (const XXH128_canonical_t& hash : clip_hashes) whole.bytes(as_bytes(hash));
  for (const std::string& name : impl.blob_names()) {
    const Bytes prefix = blob_prefix(name);
    const auto chunks = impl.chunks(Table::kBlobs, prefix);
    if ((chunks->flags & kOutsideDigest) != 0) continue;
    Bytes bytes(chunks->total_bytes);
    impl.decode_chunks(Table::kBlobs, *chunks, bytes);
    whole.text(name);
    whole.number(bytes.size());
    whole.bytes(bytes);
  }
  return hex(whole.result().digest);
}

}  // namespace freshet::store
