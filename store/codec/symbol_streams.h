// store/codec/symbol_streams.h — the entropy stage of a tile: symbols sorted by context, then one zstd frame.
//
// zstd's entropy coder knows no contexts: one Huffman table per block. So symbols that are expected to be
// alike are brought together into streams. Each stream ends a block of one and the same frame and gets a
// table of its own. Where most symbols cost less than a bit, two or four of them share a byte.
#pragma once

#include <array>

#include "store/format/format.h"

namespace freshet::store {

inline constexpr std::size_t kContexts = 16;

/// Symbols 0..255 by context, each context's in the order in which they were met.
using ContextSymbols = std::array<std::span<const std::uint8_t>, kContexts>;
inline constexpr std::size_t kSymbolsPerLoad = 8;

/// Appends one zstd frame that holds `side` (what the decoder reads first) and all symbols. Neighbouring
/// contexts are merged where a table of their own would cost more than it saves.
void encode_symbols(const ContextSymbols& symbols, ByteSpan side, Bytes& out);

/// What encode_symbols wrote, ready to be read without checks, up to kSymbolsPerLoad symbols
/// at a time, at next[context].
struct DecodedSymbols {
  std::array<const std::uint8_t*, kContexts> next{}, end{};  // of each context
  ByteSpan side;
  /// True when every context has been read to its end and not beyond.
  bool finished() const { return next == end; }
};

/// False when the bytes do not decode, or the numbers of symbols do not fit each other. The result borrows
/// the thread's scratch until the next call. `reads` symbols may be taken from it and kSymbolsPerLoad looked
/// at beyond any without leaving its memory, whatever their contexts.
/// max_side_bytes   more is refused.
bool decode_symbols(ByteSpan coded, std::size_t reads, std::size_t max_side_bytes, DecodedSymbols& symbols);

}  // namespace freshet::store
