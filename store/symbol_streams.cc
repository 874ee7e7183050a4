#include "store/symbol_streams.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "store/zstd_context.h"

namespace freshet::store {
namespace {

// How a stream's symbols lie in its bytes: 8, 4 or 2 bits each, low bits first. The largest value of 4 or 2
// bits announces a symbol that is too large; those follow, a byte each, after the packed ones.
constexpr std::array<unsigned, 3> kBits = {8, 4, 2};

// zstd's fast strategy, and no match below 7 bytes: short matches in residuals cost more than the symbols
// that they stand for. Over twelve clips 0.82 of FFV1 without the limit, 0.78 with it; levels 3 and 9 lie
// between.
constexpr int kLevel = 1, kMinMatch = 7;

using Histogram = std::array<std::uint32_t, 256>;

double log2_of(std::uint32_t n) {
  static const std::vector<float> table = [] {
    std::vector<float> values(1 << 16);
    for (std::size_t i = 1; i < values.size(); ++i) values[i] = std::log2(static_cast<float>(i));
    return values;
  }();
  return n < table.size() ? table[n] : std::log2(static_cast<float>(n));
}

// About the bits that zstd needs for symbols of this histogram: their entropy, not less than a bit each
// unless they are nearly all alike, and the block with its table, which zstd often takes over from the block
// before. Dearer tables (64 + 4 bits a symbol) gave 0.82 of FFV1 in place of 0.76.
double cost_bits(const Histogram& histogram) {
  double total = 0, bits = 0;
  int distinct = 0;
  for (const std::uint32_t n : histogram) {
    if (n == 0) continue;
    ++distinct;
    total += n;
    bits -= n * log2_of(n);
  }
  if (total == 0) return 0;
  bits += total * log2_of(static_cast<std::uint32_t>(total));
  if (distinct > 1) bits = std::max(bits, std::min(total, 4.0 * bits + 64));
  return bits + 48 + 0.2 * distinct;
}

void pack(std::span<const std::uint8_t> symbols, unsigned bits, std::vector<std::uint8_t>& packed) {
  packed.clear();
  if (bits == 8) {
    packed.assign(symbols.begin(), symbols.end());
    return;
  }
  const unsigned per_byte = 8 / bits, escape = (1u << bits) - 1;
  for (std::size_t i = 0; i < symbols.size(); i += per_byte) {
    unsigned byte = 0;
    for (unsigned k = 0; k < per_byte && i + k < symbols.size(); ++k) {
      byte |= std::min<unsigned>(symbols[i + k], escape) << (k * bits);
    }
    packed.push_back(static_cast<std::uint8_t>(byte));
  }
  for (const std::uint8_t symbol : symbols) {
    if (symbol >= escape) packed.push_back(symbol);
  }
}

// False when the stream has too few or too many bytes.
bool unpack(std::span<const std::uint8_t> packed, unsigned bits, std::span<std::uint8_t> symbols) {
  if (bits == 8) {
    if (packed.size() != symbols.size()) return false;
    std::copy(packed.begin(), packed.end(), symbols.begin());
    return true;
  }
  const unsigned per_byte = 8 / bits, escape = (1u << bits) - 1;
  const std::size_t bytes = (symbols.size() + per_byte - 1) / per_byte;
  if (packed.size() < bytes) return false;
  std::size_t large = bytes, i = 0;
  for (std::size_t b = 0; b < bytes; ++b) {
    unsigned byte = packed[b];
    for (unsigned k = 0; k < per_byte && i < symbols.size(); ++k, ++i, byte >>= bits) {
      unsigned symbol = byte & escape;
      if (symbol == escape) {
        if (large == packed.size()) return false;
        symbol = packed[large++];
      }
      symbols[i] = static_cast<std::uint8_t>(symbol);
    }
  }
  return large == packed.size();
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

// The cheapest cut of the contexts into runs: dynamic programming over the last run's first context.
std::vector<std::size_t> cut_contexts(const ContextSymbols& symbols) {
  std::array<Histogram, kContexts> histograms{};
  for (std::size_t c = 0; c < kContexts; ++c) {
    for (const std::uint8_t symbol : symbols[c]) ++histograms[c][symbol];
  }
  std::array<double, kContexts + 1> best;
  std::array<std::size_t, kContexts + 1> start{};
  best.fill(std::numeric_limits<double>::max());
  best[0] = 0;
  for (std::size_t last = 0; last < kContexts; ++last) {
    Histogram run{};
    for (std::size_t first = last + 1; first-- > 0;) {
      for (std::size_t i = 0; i < run.size(); ++i) run[i] += histograms[first][i];
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

}  // namespace

void encode_symbols(const ContextSymbols& symbols, ByteSpan side, Bytes& out) {
  struct StreamBytes {
    unsigned packing = 0;
    std::vector<std::uint8_t> bytes;
  };
  const std::vector<std::size_t> cuts = cut_contexts(symbols);
  std::vector<StreamBytes> streams(cuts.size());
  // The first context of every stream as bits, then each stream's numbers.
  std::uint32_t starts = 0;
  thread_local std::vector<std::uint8_t> joined, packed;
  Bytes head;
  for (std::size_t s = 0; s < cuts.size(); ++s) {
    starts |= 1u << cuts[s];
    joined.clear();
    const std::size_t end = s + 1 < cuts.size() ? cuts[s + 1] : kContexts;
    for (std::size_t c = cuts[s]; c < end; ++c)
      joined.insert(joined.end(), symbols[c].begin(), symbols[c].end());
    double best = std::numeric_limits<double>::max();
    for (unsigned p = 0; p < kBits.size(); ++p) {
      pack(joined, kBits[p], packed);
      Histogram histogram{};
      for (const std::uint8_t byte : packed) ++histogram[byte];
      const double cost = cost_bits(histogram);
      if (cost >= best) continue;
      best = cost;
      streams[s].packing = p;
      streams[s].bytes = packed;
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
  unpacked.resize(total + reads);
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
