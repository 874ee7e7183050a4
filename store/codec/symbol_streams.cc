#include "store/codec/symbol_streams.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "platform/vectors.h"
#include "store/codec/zstd_context.h"

namespace freshet::store {
namespace {

// How a stream's symbols lie in its bytes: 8, 4 or 2 bits each, low bits first. The largest value of 4 or 2
// bits announces a symbol that is too large; those follow, a byte each, after the packed ones.
constexpr std::array<unsigned, 3> kBits = {8, 4, 2};

// zstd's fast strategy, and no match below 7 bytes: short matches in residuals cost more than the symbols
// that they stand for. Over twelve clips 0.82 of FFV1 without the limit, 0.78 with it; levels 3 and 9 lie
// between.
constexpr int kLevel = 1, kMinMatch = 7;

/// How many times each symbol occurs, up to the largest that does.
struct Histogram {
  std::array<std::uint32_t, 256> of{};
  std::size_t size = 0;  // one more than the largest symbol
};

// Four counts of every symbol: runs of one symbol would wait for the count before.
Histogram count(std::span<const std::uint8_t> symbols) {
  std::array<std::array<std::uint32_t, 256>, 4> parts{};
  std::size_t i = 0;
  for (; i + 4 <= symbols.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) ++parts[k][symbols[i + k]];
  }
  for (; i < symbols.size(); ++i) ++parts[0][symbols[i]];
  Histogram histogram;
  for (std::size_t v = 0; v < 256; ++v) {
    histogram.of[v] = parts[0][v] + parts[1][v] + parts[2][v] + parts[3][v];
    if (histogram.of[v] != 0) histogram.size = v + 1;
  }
  return histogram;
}

void add(const Histogram& more, Histogram& to) {
  for (std::size_t v = 0; v < more.size; ++v) to.of[v] += more.of[v];
  to.size = std::max(to.size, more.size);
}

// n log2 n.
class Weights {
 public:
  Weights() : table_(1 << 16) {
    for (std::size_t n = 1; n < table_.size(); ++n) table_[n] = exact(static_cast<std::uint32_t>(n));
  }
  float operator()(std::uint32_t n) const { return n < table_.size() ? table_[n] : exact(n); }

 private:
  static float exact(std::uint32_t n) { return static_cast<float>(n) * std::log2(static_cast<float>(n)); }
  std::vector<float> table_;
};

// About the bits that zstd needs for symbols of this histogram: their entropy, not less than a bit each
// unless they are nearly all alike, and the block with its table, which zstd often takes over from the block
// before. Dearer tables (64 + 4 bits a symbol) gave 0.82 of FFV1 in place of 0.76.
double cost_bits(const Histogram& histogram) {
  static const Weights weight;
  double bits = 0;
  std::uint32_t total = 0;
  int distinct = 0;
  for (std::size_t v = 0; v < histogram.size; ++v) {
    const std::uint32_t n = histogram.of[v];
    total += n;
    distinct += n != 0;
    bits -= weight(n);
  }
  if (total == 0) return 0;
  bits += weight(total);
  if (distinct > 1) bits = std::max(bits, std::min<double>(total, 4.0 * bits + 64));
  return bits + 48 + 0.2 * distinct;
}

FRESHET_WIDE void pack_pairs(const std::uint8_t* symbols, std::size_t bytes, std::uint8_t* packed) {
  for (std::size_t i = 0; i < bytes; ++i) {
    const std::uint8_t low = std::min<std::uint8_t>(symbols[2 * i], 15),
                       high = std::min<std::uint8_t>(symbols[2 * i + 1], 15);
    packed[i] = static_cast<std::uint8_t>(low | high << 4);
  }
}

FRESHET_WIDE void pack_fours(const std::uint8_t* symbols, std::size_t bytes, std::uint8_t* packed) {
  for (std::size_t i = 0; i < bytes; ++i) {
    const std::uint8_t a = std::min<std::uint8_t>(symbols[4 * i], 3),
                       b = std::min<std::uint8_t>(symbols[4 * i + 1], 3),
                       c = std::min<std::uint8_t>(symbols[4 * i + 2], 3),
                       d = std::min<std::uint8_t>(symbols[4 * i + 3], 3);
    packed[i] = static_cast<std::uint8_t>(a | b << 2 | c << 4 | d << 6);
  }
}

// `symbols` are followed by three zeros.
void pack(std::span<const std::uint8_t> symbols, unsigned bits, std::vector<std::uint8_t>& packed) {
  if (bits == 8) {
    packed.assign(symbols.begin(), symbols.end());
    return;
  }
  const unsigned per_byte = 8 / bits, escape = (1u << bits) - 1;
  const std::size_t bytes = (symbols.size() + per_byte - 1) / per_byte;
  packed.resize(bytes + symbols.size());
  (bits == 4 ? pack_pairs : pack_fours)(symbols.data(), bytes, packed.data());
  std::uint8_t* large = packed.data() + bytes;
  for (const std::uint8_t symbol : symbols) {
    *large = symbol;
    large += symbol >= escape;
  }
  packed.resize(static_cast<std::size_t>(large - packed.data()));
}

FRESHET_WIDE void expand_pairs(const std::uint8_t* packed, std::size_t bytes, std::uint8_t* symbols) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < bytes; ++i) {
    symbols[2 * i] = packed[i] & 15;
    symbols[2 * i + 1] = packed[i] >> 4;
  }
}

FRESHET_WIDE void expand_fours(const std::uint8_t* packed, std::size_t bytes, std::uint8_t* symbols) {
#pragma GCC ivdep
  for (std::size_t i = 0; i < bytes; ++i) {
    symbols[4 * i] = packed[i] & 3;
    symbols[4 * i + 1] = packed[i] >> 2 & 3;
    symbols[4 * i + 2] = packed[i] >> 4 & 3;
    symbols[4 * i + 3] = packed[i] >> 6;
  }
}

/// Whether one of 8 bytes is zero.
bool has_zero(std::uint64_t bytes) {
  constexpr std::uint64_t kOnes = 0x0101010101010101, kTops = 0x8080808080808080;
  return ((bytes - kOnes) & ~bytes & kTops) != 0;
}

// False when the stream has too few or too many bytes.
bool unpack(std::span<const std::uint8_t> packed, unsigned bits, std::span<std::uint8_t> symbols) {
  if (bits == 8) {
    if (packed.size() != symbols.size()) return false;
    std::copy(packed.begin(), packed.end(), symbols.begin());
    return true;
  }
  const unsigned per_byte = 8 / bits, escape = (1u << bits) - 1;
  const std::size_t bytes = (symbols.size() + per_byte - 1) / per_byte, whole = symbols.size() / per_byte;
  if (packed.size() < bytes) return false;
  (bits == 4 ? expand_pairs : expand_fours)(packed.data(), whole, symbols.data());
  unsigned last = whole < bytes ? packed[whole] : 0;
  for (std::size_t i = whole * per_byte; i < symbols.size(); ++i, last >>= bits)
    symbols[i] = static_cast<std::uint8_t>(last & escape);
  // What is too large is rare: eight symbols without are passed over at once.
  std::size_t large = bytes;
  const auto put_large = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      if (symbols[i] != escape) continue;
      if (large == packed.size()) return false;
      symbols[i] = packed[large++];
    }
    return true;
  };
  const std::uint64_t escapes = 0x0101010101010101 * std::uint64_t{escape};
  std::size_t i = 0;
  for (; i + 8 <= symbols.size(); i += 8) {
    std::uint64_t group;
    std::memcpy(&group, symbols.data() + i, sizeof group);
    if (has_zero(group ^ escapes) && !put_large(i, i + 8)) return false;
  }
  return put_large(i, symbols.size()) && large == packed.size();
}

void append_number(Bytes& to, std::size_t value) {
  for (; value >= 128; value >>= 7) to.push_back(static_cast<std::byte>(value | 128));
  to.push_back(static_cast<std::byte>(value));
}

bool take_number(ByteSpan& from, std::size_t& value) {
  value = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    if (from.empty()) return false;
    const auto byte = static_cast<std::size_t>(from[0]);
    from = from.subspan(1);
    value |= (byte & 127) << shift;
    if (byte < 128) return true;
  }
  return false;
}

using ContextHistograms = std::array<Histogram, kContexts>;

// The cheapest cut of the contexts into runs: dynamic programming over the last run's first context.
std::vector<std::size_t> cut_contexts(const ContextHistograms& histograms) {
  std::array<double, kContexts + 1> best;
  std::array<std::size_t, kContexts + 1> start{};
  best.fill(std::numeric_limits<double>::max());
  best[0] = 0;
  for (std::size_t last = 0; last < kContexts; ++last) {
    Histogram run;
    for (std::size_t first = last + 1; first-- > 0;) {
      add(histograms[first], run);
      const double cost = best[first] + cost_bits(run);
      if (cost < best[last + 1]) {
        best[last + 1] = cost;
        start[last + 1] = first;
      }
    }
  }
  std::vector<std::size_t> cuts;
  for (std::size_t end = kContexts; end > 0; end = start[end]) cuts.push_back(start[end]);
  std::ranges::reverse(cuts);
  return cuts;
}

// Where more symbols than this are too large for a packing it is not tried: each costs a byte more.
constexpr std::size_t kMaxLarge = 4;  // one in so many

bool worth_packing(const Histogram& histogram, std::size_t symbols, unsigned bits) {
  std::size_t fit = 0;
  for (std::size_t v = 0; v + 1 < std::size_t{1} << bits; ++v) fit += histogram.of[v];
  return (symbols - fit) * kMaxLarge <= symbols;
}

}  // namespace

void encode_symbols(const ContextSymbols& symbols, ByteSpan side, Bytes& out) {
  struct StreamBytes {
    unsigned packing = 0;
    std::vector<std::uint8_t> bytes;
  };
  ContextHistograms histograms;
  for (std::size_t c = 0; c < kContexts; ++c) histograms[c] = count(symbols[c]);
  const std::vector<std::size_t> cuts = cut_contexts(histograms);
  thread_local std::array<StreamBytes, kContexts> stream_bytes;
  const std::span streams(stream_bytes.data(), cuts.size());
  // The first context of every stream as bits, then each stream's numbers.
  std::uint32_t starts = 0;
  thread_local std::vector<std::uint8_t> joined, packed;
  thread_local Bytes head;
  head.clear();
  for (std::size_t s = 0; s < cuts.size(); ++s) {
    starts |= 1u << cuts[s];
    joined.clear();
    Histogram histogram;
    const std::size_t end = s + 1 < cuts.size() ? cuts[s + 1] : kContexts;
    for (std::size_t c = cuts[s]; c < end; ++c) {
      joined.insert(joined.end(), symbols[c].begin(), symbols[c].end());
      add(histograms[c], histogram);
    }
    const std::size_t joined_symbols = joined.size();
    joined.insert(joined.end(), 3, 0);
    double best = std::numeric_limits<double>::max();
    for (unsigned p = 0; p < kBits.size(); ++p) {
      if (kBits[p] != 8 && !worth_packing(histogram, joined_symbols, kBits[p])) continue;
      pack({joined.data(), joined_symbols}, kBits[p], packed);
      const double cost = cost_bits(kBits[p] == 8 ? histogram : count(packed));
      if (cost >= best) continue;
      best = cost;
      streams[s].packing = p;
      streams[s].bytes.swap(packed);
    }
  }
  append(head, static_cast<std::uint16_t>(starts));
  for (const auto& context : symbols) append_number(head, context.size());
  for (const StreamBytes& stream : streams) append_number(head, stream.bytes.size() << 2 | stream.packing);
  append_number(head, side.size());
  head.insert(head.end(), side.begin(), side.end());

  std::size_t total = head.size();
  for (const StreamBytes& stream : streams) total += stream.bytes.size();
  ZSTD_CCtx* context = thread_compressor();
  ZSTD_CCtx_reset(context, ZSTD_reset_session_and_parameters);
  ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
  ZSTD_CCtx_setParameter(context, ZSTD_c_minMatch, kMinMatch);
  ZSTD_CCtx_setPledgedSrcSize(context, total);
  const std::size_t at = out.size();
  out.resize(at + ZSTD_compressBound(total) + 32 * (streams.size() + 2));
  ZSTD_outBuffer target{out.data() + at, out.size() - at, 0};
  const auto put = [&](const void* bytes, std::size_t size, ZSTD_EndDirective how) {
    ZSTD_inBuffer source{bytes, size, 0};
    check_zstd(ZSTD_compressStream2(context, &target, &source, how));
  };
  put(head.data(), head.size(), ZSTD_e_flush);
  for (const StreamBytes& stream : streams) put(stream.bytes.data(), stream.bytes.size(), ZSTD_e_flush);
  put(nullptr, 0, ZSTD_e_end);
  out.resize(at + target.pos);
}

bool decode_symbols(ByteSpan coded, std::size_t reads, std::size_t max_side_bytes, DecodedSymbols& symbols) {
  thread_local Bytes raw;
  thread_local std::vector<std::uint8_t> unpacked;
  // Every symbol takes at most two bytes (an escape and itself), the head a few.
  constexpr std::size_t kMaxHead = 2 + kContexts * 10 + 5;
  const auto raw_bytes = ZSTD_getFrameContentSize(coded.data(), coded.size());
  if (raw_bytes > 2 * reads + max_side_bytes + kMaxHead) return false;  // also when unknown or no frame
  raw.resize(raw_bytes);
  if (!zstd_expand(coded, raw)) return false;

  ByteSpan rest = raw;
  if (rest.size() < 2) return false;
  const auto starts = load<std::uint16_t>(rest.data());
  if ((starts & 1) == 0) return false;
  rest = rest.subspan(2);
  struct StreamBytes {
    std::size_t symbols = 0, packing = 0, bytes = 0;
  };
  std::array<StreamBytes, kContexts> streams{};
  std::array<std::size_t, kContexts> counts{};
  std::size_t stream_count = 0, total = 0;
  for (std::size_t c = 0; c < kContexts; ++c) {
    if (!take_number(rest, counts[c]) || counts[c] > reads) return false;
    if ((starts >> c & 1) != 0) ++stream_count;
    streams[stream_count - 1].symbols += counts[c];
    total += counts[c];
  }
  for (std::size_t s = 0; s < stream_count; ++s) {
    if (!take_number(rest, streams[s].bytes)) return false;
    streams[s].packing = streams[s].bytes & 3;
    streams[s].bytes >>= 2;
    if (streams[s].packing >= kBits.size()) return false;
  }
  std::size_t side_bytes = 0;
  if (total > reads || !take_number(rest, side_bytes) || side_bytes > rest.size()) return false;
  symbols.side = rest.first(side_bytes);
  rest = rest.subspan(side_bytes);

  // A stream that is read beyond its end runs into the next ones and then into the slack, never out of
  // memory.
  unpacked.resize(total + reads + kSymbolsPerLoad);
  std::uint8_t* to = unpacked.data();
  for (std::size_t s = 0; s < stream_count; ++s) {
    const StreamBytes& stream = streams[s];
    if (stream.bytes > rest.size()) return false;
    const std::span packed(reinterpret_cast<const std::uint8_t*>(rest.data()), stream.bytes);
    if (!unpack(packed, kBits[stream.packing], {to, stream.symbols})) return false;
    to += stream.symbols;
    rest = rest.subspan(stream.bytes);
  }
  to = unpacked.data();
  for (std::size_t c = 0; c < kContexts; ++c) {
    symbols.next[c] = to;
    symbols.end[c] = to += counts[c];
  }
  return rest.empty();
}

}  // namespace freshet::store
