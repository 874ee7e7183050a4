#include "media/picture/capture_time.h"

#include <cstdint>
#include <cstdio>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "media/picture/picture_file.h"
#include "media/picture/tiff_tags.h"

namespace freshet::media {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr unsigned kDateTime = 0x0132, kExifDirectory = 0x8769, kDateTimeOriginal = 0x9003;
constexpr std::size_t kDateLength = 19;  // YYYY:MM:DD HH:MM:SS

std::size_t big_endian(Bytes bytes, std::size_t at, int count) {
  std::size_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
  return value;
}

// A JPEG's segment, a PNG's chunk, or the whole of a TIFF: in each case a TIFF header and its directories.
Bytes exif_of(Bytes file) {
  if (file.size() < 16) return {};
  if (file[0] == 'I' || file[0] == 'M') return file;
  if (file[0] == 0xFF && file[1] == 0xD8) {
    for (std::size_t at = 2; at + 10 <= file.size() && file[at] == 0xFF && file[at + 1] != 0xDA;) {
      const std::size_t length = big_endian(file, at + 2, 2);
      if (length < 2 || length > file.size() - at - 2) return {};
      if (file[at + 1] == 0xE1 && length > 8 && std::memcmp(&file[at + 4], "Exif\0\0", 6) == 0)
        return file.subspan(at + 10, length - 8);
      at += 2 + length;
    }
  }
  if (std::memcmp(file.data(), "\x89PNG", 4) == 0) {
    for (std::size_t at = 8; at + 12 <= file.size();) {
      const std::size_t length = big_endian(file, at, 4);
      if (length > file.size() - at - 12) return {};
      if (std::memcmp(&file[at + 4], "eXIf", 4) == 0) return file.subspan(at + 8, length);
      at += 12 + length;
    }
  }
  return {};
}

std::string date(const TiffTags& exif, const std::optional<TiffTags::Tag>& tag) {
  const Bytes text = tag ? exif.bytes_of(*tag) : Bytes();
  if (text.size() < kDateLength) return {};
  return {text.begin(), text.begin() + static_cast<std::ptrdiff_t>(kDateLength)};
}

std::optional<std::chrono::sys_seconds> parsed(const std::string& date) {
  using namespace std::chrono;
  int y = 0, month_of = 0, d = 0, h = 0, m = 0, s = 0;
  if (std::sscanf(date.c_str(), "%4d:%2d:%2d %2d:%2d:%2d", &y, &month_of, &d, &h, &m, &s) != 6)
    return std::nullopt;
  const year_month_day day{year(y), month(static_cast<unsigned>(month_of)),
                           std::chrono::day(static_cast<unsigned>(d))};
  if (!day.ok() || h < 0 || h > 23 || m < 0 || m > 59 || s < 0 || s > 60) return std::nullopt;
  return sys_days(day) + hours(h) + minutes(m) + seconds(s);
}

}  // namespace

std::optional<std::chrono::sys_seconds> capture_time(const std::filesystem::path& path) {
  const std::vector<std::uint8_t> file = read_bytes(path);
  const TiffTags exif(exif_of(file));
  if (const auto own = exif.find(kExifDirectory))
    if (const auto taken = parsed(date(exif, exif.find(kDateTimeOriginal, exif.number(*own))))) return taken;
  return parsed(date(exif, exif.find(kDateTime)));
}

}  // namespace freshet::media
