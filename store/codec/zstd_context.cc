#include "store/codec/zstd_context.h"

#include <memory>

#include "freshet/error.h"

namespace freshet::store {
namespace {

[[noreturn]] void throw_zstd(const char* what) {
  throw Error(ErrorKind::kIo, "zstd", what, "Free memory and run again");
}

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

}  // namespace

ZSTD_CCtx* thread_compressor() {
  thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (!context) throw_zstd("out of memory");
  return context.get();
}

ZSTD_DCtx* thread_expander() {
  thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
  if (!context) throw_zstd("out of memory");
  return context.get();
}

void check_zstd(std::size_t code) {
  if (ZSTD_isError(code)) throw_zstd(ZSTD_getErrorName(code));
}

Bytes zstd_compress(ByteSpan raw, int level) {
  ZSTD_CCtx* context = thread_compressor();
  ZSTD_CCtx_reset(context, ZSTD_reset_session_and_parameters);
  ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
  Bytes out(ZSTD_compressBound(raw.size()));
  const std::size_t size = ZSTD_compress2(context, out.data(), out.size(), raw.data(), raw.size());
  check_zstd(size);
  out.resize(size);
  return out;
}

bool zstd_expand(ByteSpan stored, std::span<std::byte> out) {
  if (ZSTD_getFrameContentSize(stored.data(), stored.size()) != out.size()) return false;
  if (ZSTD_findFrameCompressedSize(stored.data(), stored.size()) != stored.size()) return false;
  return ZSTD_decompressDCtx(thread_expander(), out.data(), out.size(), stored.data(), stored.size()) ==
         out.size();
}

}  // namespace freshet::store
