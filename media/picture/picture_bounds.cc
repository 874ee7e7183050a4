#include "media/picture/picture_bounds.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string_view>

#include <fmt/format.h>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/frame/png_chunks.h"
#include "media/picture/tiff_tags.h"

namespace freshet::media {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::uint64_t kMaxPixelsPerByte = 1 << 14, kAlwaysFine = 1 << 24;
constexpr const char* kSaveAsPng = "Save it again as PNG";

std::uint64_t big_endian(Bytes bytes, std::size_t at, int count) {
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

std::uint64_t little_endian(Bytes bytes, std::size_t at, int count) {
  std::uint64_t value = 0;
  for (int i = count; i-- > 0;) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

cv::Size clipped(std::uint64_t width, std::uint64_t height) {
  constexpr std::uint64_t kMax = 0x7FFFFFFF;
  return {static_cast<int>(std::min(width, kMax)), static_cast<int>(std::min(height, kMax))};
}

bool starts(Bytes bytes, std::string_view magic, std::size_t at = 0) {
  return bytes.size() >= at + magic.size() && std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
}

struct JpegHeader {
  std::optional<cv::Size> size;  // of the first frame
  int frames = 0, scans = 0;
};

/// Markers that FFmpeg and libjpeg know to have a length behind them. The bytes behind all others are looked through.
bool has_length(std::uint8_t marker) {
  return (marker >= 0xC0 && marker <= 0xCF) || (marker >= 0xDA && marker <= 0xDD) ||
         (marker >= 0xE0 && marker <= 0xEF) || marker == 0xFE;
}

/// Up to the end of the first picture in the file.
JpegHeader jpeg_header(Bytes bytes) {
  JpegHeader header;
  std::size_t at = 2;
  while (at < bytes.size()) {
    const void* const next = std::memchr(bytes.data() + at, 0xFF, bytes.size() - at);
    if (next == nullptr) break;
    at = static_cast<std::size_t>(static_cast<const std::uint8_t*>(next) - bytes.data());
    if (at + 4 > bytes.size()) break;
    const std::uint8_t marker = bytes[at + 1];
    if (marker == 0xD9 && header.scans > 0) break;
    if (!has_length(marker)) {
      at += marker == 0xFF ? 1 : 2;
      continue;
    }
    // C4, C8 and CC in this range are other things.
    if (marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC) {
      ++header.frames;
      if (!header.size && at + 9 <= bytes.size())
        header.size = clipped(big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2));
    }
    if (marker == 0xDA) ++header.scans;
    at += 2 + big_endian(bytes, at + 2, 2);
  }
  return header;
}

std::optional<cv::Size> tiff_size(const TiffTags& tags) {
  const std::uint64_t width = tags.number(256), height = tags.number(257);
  if (width == 0 || height == 0) return std::nullopt;
  return clipped(width, height);
}

std::optional<cv::Size> webp_size(Bytes bytes) {
  if (bytes.size() < 30) return std::nullopt;
  const auto at = [&](std::size_t i, int count) { return little_endian(bytes, i, count); };
  if (starts(bytes, "VP8X", 12)) return clipped(1 + at(24, 3), 1 + at(27, 3));
  if (starts(bytes, "VP8L", 12)) return clipped(1 + (at(21, 4) & 0x3FFF), 1 + (at(21, 4) >> 14 & 0x3FFF));
  if (starts(bytes, "VP8 ", 12)) return clipped(at(26, 2) & 0x3FFF, at(28, 2) & 0x3FFF);
  return std::nullopt;
}

/// The first whole numbers of a header in text, behind `at`. Comments run from # to the line's end.
std::optional<cv::Size> size_in_text(Bytes bytes, std::size_t at) {
  std::array<std::uint64_t, 2> found{};
  const char* const text = reinterpret_cast<const char*>(bytes.data());
  const std::size_t end = std::min<std::size_t>(bytes.size(), at + 4096);
  for (std::size_t i = 0; i < found.size();) {
    if (at >= end) return std::nullopt;
    if (text[at] == '#') {
      while (at < end && text[at] != '\n') ++at;
    } else if (text[at] >= '0' && text[at] <= '9') {
      const auto [next, fault] = std::from_chars(text + at, text + end, found[i]);
      if (fault != std::errc()) found[i] = ~std::uint64_t{0};
      at = static_cast<std::size_t>(next - text);
      ++i;
    } else {
      ++at;
    }
  }
  return clipped(found[0], found[1]);
}

/// Of a PAM, whose lines stand in any order.
std::optional<cv::Size> pam_size(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 4096));
  const auto number = [&](std::string_view name) -> std::uint64_t {
    const std::size_t at = text.find(name);
    const std::optional<cv::Size> found =
        at == std::string_view::npos ? std::nullopt : size_in_text(bytes, at);
    return found ? static_cast<std::uint64_t>(found->width) : 0;
  };
  return clipped(number("\nWIDTH "), number("\nHEIGHT "));
}

std::optional<cv::Size> radiance_size(Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()),
                              std::min<std::size_t>(bytes.size(), 1 << 16));
  const std::size_t at = text.find("\n-Y ");  // the only order that OpenCV reads
  if (at == std::string_view::npos) return std::nullopt;
  const std::optional<cv::Size> turned = size_in_text(bytes, at);
  return turned ? std::optional(cv::Size(turned->height, turned->width)) : std::nullopt;
}

/// Where the size in a JPEG 2000 stands.
std::optional<std::size_t> jpeg_2000_header(Bytes bytes) {
  if (!starts(bytes, "\xFF\x4F\xFF\x51") && !starts(bytes, "jP  ", 4)) return std::nullopt;
  static constexpr std::array<std::uint8_t, 4> kStart{0xFF, 0x4F, 0xFF, 0x51};
  const auto at = std::search(bytes.begin(), bytes.end(), kStart.begin(), kStart.end());
  if (bytes.end() - at < 42) return std::nullopt;
  return static_cast<std::size_t>(at - bytes.begin());
}

std::optional<cv::Size> jpeg_2000_size(Bytes bytes) {
  const std::optional<std::size_t> at = jpeg_2000_header(bytes);
  if (!at) return std::nullopt;
  return clipped(big_endian(bytes, *at + 8, 4), big_endian(bytes, *at + 12, 4));
}

[[noreturn]] void refuse(const std::string& where, const std::string& fault) {
  throw Error(ErrorKind::kInput, where, fault, kSaveAsPng);
}

void require_bounded_jpeg(Bytes bytes, const std::string& where) {
  constexpr int kMaxScans = 100;  // each passes over all pixels; encoders write some ten
  const JpegHeader header = jpeg_header(bytes);
  if (header.frames > 1) refuse(where, "the picture is damaged (it has a second header)");
  if (header.scans > kMaxScans)
    refuse(where, fmt::format("it has {} scans, at most {} are expected", header.scans, kMaxScans));
}

void require_bounded_tiff(Bytes bytes, std::uint64_t pixels, const std::string& where) {
  constexpr std::uint64_t kSlack = 1 << 20, kMaxSamples = 16, kSmallTile = 1 << 22;
  const TiffTags tiff(bytes);
  // What lies in a file twice is read twice.
  std::uint64_t claimed = 0;
  for (const TiffTags::Tag& tag : tiff.tags())
    claimed += std::min(TiffTags::length_of(tag), kSlack + bytes.size());
  if (claimed > bytes.size() + kSlack)
    refuse(where, fmt::format("its tags claim {} bytes, and it has {}", claimed, bytes.size()));
  std::uint64_t packed = 0;
  for (const unsigned counts : {279u, 325u})
    if (const std::optional<TiffTags::Tag> tag = tiff.find(counts))
      for (std::uint64_t i = 0; i < std::min<std::uint64_t>(tag->count, bytes.size()); ++i)
        packed += std::min<std::uint64_t>(tiff.number(*tag, i), bytes.size());
  if (packed > 2 * bytes.size() + kSlack)
    refuse(where, fmt::format("its strips claim {} bytes, and it has {}", packed, bytes.size()));
  if (const std::uint64_t samples = tiff.number(277u); samples > kMaxSamples)
    refuse(where, fmt::format("it has {} samples per pixel", samples));
  const std::uint64_t wide = tiff.number(322u), high = tiff.number(323u);
  if (wide > kSmallTile || high > kSmallTile || wide * high > std::max(pixels, kSmallTile))
    refuse(where, fmt::format("its tiles are {} x {} pixels large", wide, high));
}

void require_bounded_jpeg_2000(Bytes bytes, std::size_t at, std::uint64_t pixels, const std::string& where) {
  constexpr std::uint64_t kMaxComponents = 4, kFewTiles = 64, kSmallTile = 1 << 10;
  const auto number = [&](std::size_t offset) { return big_endian(bytes, at + offset, 4); };
  if (const std::uint64_t components = big_endian(bytes, at + 40, 2); components > kMaxComponents)
    refuse(where, fmt::format("it has {} components", components));
  const std::uint64_t wide = std::max<std::uint64_t>(number(24), 1),
                      high = std::max<std::uint64_t>(number(28), 1);
  const std::uint64_t tiles = (number(8) / wide + 1) * (number(12) / high + 1);
  if (tiles > kFewTiles + pixels / kSmallTile) refuse(where, fmt::format("it has {} tiles", tiles));
}

}  // namespace

std::optional<cv::Size> claimed_size(Bytes bytes) {
  if (starts(bytes, "P7")) return pam_size(bytes);
  if (bytes.size() > 2 && bytes[0] == 'P' && std::strchr("123456Ff", bytes[1]) != nullptr)
    return size_in_text(bytes, 2);
  if (bytes.size() < 26) return std::nullopt;
  if (starts(bytes, "\x89PNG")) return clipped(big_endian(bytes, 16, 4), big_endian(bytes, 20, 4));
  if (starts(bytes, "\xFF\xD8")) return jpeg_header(bytes).size;
  if (starts(bytes, "BM")) {
    const auto rows = static_cast<std::int32_t>(little_endian(bytes, 22, 4));  // negative: top row first
    return clipped(little_endian(bytes, 18, 4),
                   rows < 0 ? 0u - static_cast<std::uint32_t>(rows) : static_cast<std::uint32_t>(rows));
  }
  if (starts(bytes, "RIFF") && starts(bytes, "WEBP", 8)) return webp_size(bytes);
  if (starts(bytes, "#?RGBE") || starts(bytes, "#?RADIANCE")) return radiance_size(bytes);
  if (starts(bytes, "\x59\xa6\x6a\x95")) return clipped(big_endian(bytes, 4, 4), big_endian(bytes, 8, 4));
  if (const std::optional<cv::Size> size = jpeg_2000_size(bytes)) return size;
  return tiff_size(TiffTags(bytes));
}

std::vector<std::uint8_t> bounded_picture(std::vector<std::uint8_t> bytes, const std::string& where) {
  const std::optional<cv::Size> size = claimed_size(bytes);
  if (!size)
    throw Error(ErrorKind::kInput, where, "not a picture that OpenCV can read",
                "Save it as PNG, JPEG or TIFF");
  const std::uint64_t pixels =
      static_cast<std::uint64_t>(size->width) * static_cast<std::uint64_t>(size->height);
  if (pixels > static_cast<std::uint64_t>(kMaxPicturePixels))
    throw Error(ErrorKind::kInput, where, fmt::format("is {} x {} pixels large", size->width, size->height),
                "Reduce it below 2^28 pixels");
  if (pixels > kAlwaysFine && pixels > kMaxPixelsPerByte * bytes.size())
    refuse(where, fmt::format("it claims {} x {} pixels, and has {} bytes", size->width, size->height,
                              bytes.size()));
  if (starts(bytes, "\x89PNG")) return pixel_chunks(bytes, where);
  if (starts(bytes, "\xFF\xD8")) require_bounded_jpeg(bytes, where);
  if (const std::optional<std::size_t> at = jpeg_2000_header(bytes))
    require_bounded_jpeg_2000(bytes, *at, pixels, where);
  require_bounded_tiff(bytes, pixels, where);
  return bytes;
}

}  // namespace freshet::media
