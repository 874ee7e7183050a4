// The digest: XXH3-128 of the logical content, defined in docs/format.md. It hashes what a reader gets, never
// what lies on disk, so it outlives other codecs, record sizes and versions of zstd.

#include <oneapi/tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "freshet/error.h"
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

std::string hex(const XXH128_canonical_t& hash) {
  static constexpr char kHex[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : hash.digest) {
    text += kHex[byte >> 4];
    text += kHex[byte & 15];
  }
  return text;
}

}  // namespace

struct Snapshot::Impl::Digest {
  const Impl& impl;

  XXH128_canonical_t clip(ClipId id) const;
  void stream(ClipId id, Stream stream, Hasher& hasher) const;
};

XXH128_canonical_t Snapshot::Impl::Digest::clip(ClipId id) const {
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
  for (std::size_t s = 0; s < kStreams; ++s) stream(id, static_cast<Stream>(s), hasher);
  for (const auto& [name, account] : impl.stored(id).columns) {
    const Bytes bytes = impl.array(Table::kColumns, column_prefix(id, name), account);
    hasher.text(name);
    hasher.number(account.element_bytes);
    hasher.number(bytes.size());
    hasher.bytes(bytes);
  }
  return hasher.result();
}

// Decoded, slab by slab.
void Snapshot::Impl::Digest::stream(ClipId id, Stream stream, Hasher& hasher) const {
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
}

std::string Snapshot::digest() const {
  if (const std::vector<std::string> faults = check_account(); !faults.empty()) {
    std::string first = faults.front();
    if (first.ends_with('.')) first.pop_back();  // which an error adds
    throw Error(ErrorKind::kDamaged, path().string(),
                "is damaged, in " + std::to_string(faults.size()) + " places at least. The first: " + first);
  }
  std::vector<ClipId> order(clips().begin(), clips().end());
  std::ranges::sort(order, {}, [&](ClipId id) {
    const ClipRecord& record = clip(id);
    return std::tie(record.source_hash, record.name);
  });
  std::vector<XXH128_canonical_t> clip_hashes(order.size());
  tbb::parallel_for(std::size_t{0}, order.size(), [&](std::size_t i) {
    const Place at = place(order[i]);
    clip_hashes[i] = Impl::Digest{at.file}.clip(at.id);
  });

  Hasher whole;
  whole.text("freshet digest 1");
  whole.text(settings());
  whole.number(order.size());
  for (const XXH128_canonical_t& hash : clip_hashes) whole.bytes(as_bytes(hash));
  for (const auto& [name, account] : each_file().front()->accounted().blobs) {
    if ((account.flags & kOutsideDigest) != 0) continue;
    const std::optional<Bytes> bytes = blob(name);
    if (!bytes) continue;
    whole.text(name);
    whole.number(bytes->size());
    whole.bytes(*bytes);
  }
  return hex(whole.result());
}

}  // namespace freshet::store
