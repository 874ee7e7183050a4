// store/codec/zstd_context.h — zstd frames with content size and checksum, through one context per thread.
#pragma once

#include <zstd.h>

#include "store/format/format.h"

namespace freshet::store {

/// The calling thread's contexts. A context costs some hundred KB and much more time than a tile to make.
/// Throws Error{kIo} when memory is out.
ZSTD_CCtx* thread_compressor();
ZSTD_DCtx* thread_expander();

/// Throws Error{kIo} where zstd returns an error.
void check_zstd(std::size_t code);

/// One frame. Throws Error{kIo} when memory is out.
Bytes zstd_compress(ByteSpan raw, int level);

/// False unless `stored` is one whole frame that says that it holds out.size() bytes,
/// does, and fits its checksum.
bool zstd_expand(ByteSpan stored, std::span<std::byte> out);

}  // namespace freshet::store
