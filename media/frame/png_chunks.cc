#include "media/frame/png_chunks.h"

#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <set>
#include <string_view>

#include "freshet/error.h"

namespace freshet::media {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::size_t kHead = 8, kTail = 4;  // length and type; checksum
constexpr std::size_t kMaxProfile = 16u << 20;
// fcTL is one a frame; the others are one a file.
constexpr std::array<std::string_view, 4> kPixels{"IDAT", "fdAT", "fcTL", "IEND"};
constexpr std::array<std::string_view, 9> kOnce{"IHDR", "PLTE", "tRNS", "gAMA", "cHRM",
                                                "sRGB", "iCCP", "eXIf", "acTL"};

std::uint64_t big_endian(Bytes bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[at + i];
  return value;
}

/// Most bytes that the pixels take when they are packed badly: as blocks that are stored, one a row.
std::uint64_t most_packed(Bytes header) {
  if (header.size() < 13) return ~std::uint64_t{0};
  static constexpr std::array<std::uint64_t, 7> kSamples{1, 1, 3, 1, 2, 1, 4};
  const std::uint64_t width = std::min(big_endian(header, 0), std::uint64_t{1} << 31);
  const std::uint64_t height = std::min(big_endian(header, 4), std::uint64_t{1} << 31);
  const std::uint64_t row = 1 + (width * header[8] * kSamples[std::min<std::size_t>(header[9], 6)] + 7) / 8;
  // Seven passes of an interlaced picture have at most two rows for each of its own.
  return 2 * height * (row / 1000 + 64) + row * height + (64u << 10);
}

bool unpacks_within(Bytes packed, std::size_t most) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  std::array<std::uint8_t, 1u << 14> scratch;
  stream.next_in = packed.data();
  stream.avail_in = static_cast<uInt>(packed.size());
  int code = Z_OK;
  while (code == Z_OK && stream.total_out <= most) {
    stream.next_out = scratch.data();
    stream.avail_out = scratch.size();
    code = inflate(&stream, Z_NO_FLUSH);
  }
  const bool within = stream.total_out <= most;
  inflateEnd(&stream);
  return within;
}

void require_small_profile(Bytes chunk, const std::string& where) {
  const auto name_ends = std::find(chunk.begin(), chunk.end(), 0);
  const auto name = static_cast<std::size_t>(name_ends - chunk.begin());
  if (name + 2 >= chunk.size() || unpacks_within(chunk.subspan(name + 2), kMaxProfile)) return;
  throw Error(ErrorKind::kInput, where, "its colour profile unpacks to more than 16 MiB",
              "Convert it to sRGB in your picture program, or save it without a profile");
}

void append_chunk(std::vector<std::uint8_t>& out, std::string_view type, Bytes data) {
  if (data.empty()) return;
  const auto put = [&](std::uint64_t number) {
    for (int i = 3; i >= 0; --i) out.push_back(static_cast<std::uint8_t>(number >> 8 * i));
  };
  put(data.size());
  const std::size_t from = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), data.begin(), data.end());
  put(crc32(0, out.data() + from, static_cast<uInt>(out.size() - from)));
}

}  // namespace

std::vector<std::uint8_t> pixel_chunks(Bytes png, const std::string& where) {
  std::size_t at = png.size() >= 8 && std::memcmp(png.data(), "\x89PNG\r\n\x1a\n", 8) == 0 ? 8 : 0;
  std::vector<std::uint8_t> out(png.begin(), png.begin() + static_cast<std::ptrdiff_t>(at));
  std::set<std::string_view> seen;
  std::uint64_t most = ~std::uint64_t{0}, room = most;  // of packed pixels, in a frame
  while (png.size() - at >= kHead) {
    const std::uint64_t length = big_endian(png, at);
    if (length > png.size() - at - kHead) break;
    const std::string_view type(reinterpret_cast<const char*>(png.data()) + at + 4, 4);
    const Bytes data = png.subspan(at + kHead, length);
    const Bytes whole = png.subspan(at, std::min(kHead + length + kTail, png.size() - at));
    at += whole.size();
    const bool pixels = std::ranges::find(kPixels, type) != kPixels.end();
    if (!pixels && (std::ranges::find(kOnce, type) == kOnce.end() || !seen.insert(type).second)) continue;
    if (type == "IHDR") most = most_packed(data);
    if (type == "IHDR" || type == "fcTL") room = most;
    if (type == "iCCP") require_small_profile(data, where);
    if (type == "IDAT" || type == "fdAT") {
      const std::uint64_t kept = std::min(room, length);
      room -= kept;
      if (kept < length) append_chunk(out, type, data.first(kept));
      if (kept < length || length == 0) continue;
    }
    out.insert(out.end(), whole.begin(), whole.end());
    if (type == "IEND") return out;
  }
  out.insert(out.end(), png.begin() + static_cast<std::ptrdiff_t>(at), png.end());
  return out;
}

}  // namespace freshet::media
