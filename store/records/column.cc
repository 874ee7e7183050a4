#include "store/records/column.h"

#include <zstd.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>

#include "store/codec/zstd_context.h"

namespace freshet::store {
namespace {

// Level 3: on patch columns 9 gains 2 % and costs five times the time.
constexpr int kLevel = 3;

// Byte k of every element, for k = 0, 1, ...; a tail shorter than an element stays as it is.
void shuffle(ByteSpan raw, std::size_t element, std::byte* out) {
  const std::size_t count = raw.size() / element;
  for (std::size_t k = 0; k < element; ++k) {
    for (std::size_t i = 0; i < count; ++i) *out++ = raw[i * element + k];
  }
  std::copy(raw.begin() + static_cast<std::ptrdiff_t>(count * element), raw.end(), out);
}

typedef unsigned char Sixteen __attribute__((vector_size(16)));
constexpr std::size_t kSide = sizeof(Sixteen);

// Rows become columns: two rounds of interleaving rows i and i + 8 would halve the distance of neighbours
// twice, four bring them together.
void transpose(Sixteen (&rows)[kSide]) {
  Sixteen other[kSide];
  const auto interleave = [&](const Sixteen(&from)[kSide], Sixteen(&to)[kSide]) {
    for (std::size_t i = 0; i < kSide / 2; ++i) {
      to[2 * i] = __builtin_shufflevector(from[i], from[i + kSide / 2], 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5,
                                          21, 6, 22, 7, 23);
      to[2 * i + 1] = __builtin_shufflevector(from[i], from[i + kSide / 2], 8, 24, 9, 25, 10, 26, 11, 27, 12,
                                              28, 13, 29, 14, 30, 15, 31);
    }
  };
  interleave(rows, other);
  interleave(other, rows);
  interleave(rows, other);
  interleave(other, rows);
}

// By squares of 16 elements and 16 of their bytes: byte by byte, cells (104 bytes) came at 0.6 GB/s, and
// labelling waited for them.
void unshuffle(const std::byte* from, std::size_t element, std::span<std::byte> raw) {
  const std::size_t count = raw.size() / element;
  std::size_t i = 0;
  // The last bytes of an element are written as if it had 16 more, over its follower's first: those are
  // written later, and the last elements byte by byte.
  for (; i + 2 * kSide <= count; i += kSide) {
    for (std::size_t block = (element + kSide - 1) / kSide; block-- > 0;) {
      Sixteen bytes[kSide];
      for (std::size_t k = 0; k < kSide; ++k) {
        const std::size_t plane = std::min(block * kSide + k, element - 1);
        std::memcpy(&bytes[k], from + plane * count + i, kSide);
      }
      transpose(bytes);
      for (std::size_t k = 0; k < kSide; ++k)
        std::memcpy(raw.data() + (i + k) * element + block * kSide, &bytes[k], kSide);
    }
  }
  for (std::size_t k = 0; k < element; ++k)
    for (std::size_t rest = i; rest < count; ++rest) raw[rest * element + k] = from[k * count + rest];
  std::copy(from + element * count, from + raw.size(),
            raw.begin() + static_cast<std::ptrdiff_t>(element * count));
}

}  // namespace

Codec compress_column(ByteSpan raw, std::uint32_t element_bytes, Bytes& out) {
  const std::size_t start = out.size();
  Bytes plain = zstd_compress(raw, kLevel);
  Codec codec = Codec::kZstd;
  if (element_bytes > 1 && element_bytes <= 256) {
    Bytes shuffled(raw.size());
    shuffle(raw, element_bytes, shuffled.data());
    shuffled = zstd_compress(shuffled, kLevel);
    if (shuffled.size() < plain.size()) {
      plain.swap(shuffled);
      codec = Codec::kShuffle;
    }
  }
  if (plain.size() >= raw.size()) {
    out.insert(out.end(), raw.begin(), raw.end());
    return Codec::kRaw;
  }
  out.resize(start + plain.size());
  std::copy(plain.begin(), plain.end(), out.begin() + static_cast<std::ptrdiff_t>(start));
  return codec;
}

bool expand_column(Codec codec, ByteSpan stored, std::uint32_t element_bytes, std::span<std::byte> out) {
  switch (codec) {
    case Codec::kRaw:
      if (stored.size() != out.size()) return false;
      std::copy(stored.begin(), stored.end(), out.begin());
      return true;
    case Codec::kZstd:
      return zstd_expand(stored, out);
    case Codec::kShuffle: {
      if (element_bytes < 2 || element_bytes > 256) return false;
      const auto shuffled = std::make_unique_for_overwrite<std::byte[]>(out.size());
      if (!zstd_expand(stored, {shuffled.get(), out.size()})) return false;
      unshuffle(shuffled.get(), element_bytes, out);
      return true;
    }
    case Codec::kTiles:
      break;
  }
  return false;
}

}  // namespace freshet::store
