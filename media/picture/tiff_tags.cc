#include "media/picture/tiff_tags.h"

#include <algorithm>
#include <array>

namespace freshet::media {
namespace {

std::uint64_t size_of(unsigned type) {
  static constexpr std::array<std::uint8_t, 19> kSizes{0, 1, 1, 2, 4, 8, 1, 1, 2, 4,
                                                       8, 4, 8, 4, 0, 0, 8, 8, 8};
  return type < kSizes.size() ? kSizes[type] : 0;
}

}  // namespace

TiffTags::TiffTags(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
  if (bytes.size() < 16 || bytes[0] != bytes[1] || (bytes[0] != 'I' && bytes[0] != 'M')) return;
  little_ = bytes[0] == 'I';
  big_ = read(2, 2) == 43;
  known_ = big_ || read(2, 2) == 42;
}

std::vector<TiffTags::Tag> TiffTags::tags(std::optional<std::uint64_t> directory) const {
  std::vector<Tag> tags;
  if (!known_) return tags;
  const std::uint64_t from = directory ? *directory : big_ ? read(8, 8) : read(4, 4);
  if (from == 0 || from > bytes_.size()) return tags;
  const int wide = big_ ? 8 : 4;
  const std::uint64_t entry = big_ ? 20 : 12;
  const std::uint64_t count = std::min(read(from, big_ ? 8 : 2), bytes_.size() / entry);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t at = from + (big_ ? 8 : 2) + i * entry;
    if (at + entry > bytes_.size()) break;
    Tag tag{.tag = static_cast<unsigned>(read(at, 2)),
            .type = static_cast<unsigned>(read(at + 2, 2)),
            .count = read(at + 4, wide),
            .value_at = at + 4 + static_cast<std::uint64_t>(wide)};
    if (length_of(tag) > static_cast<std::uint64_t>(wide)) tag.value_at = read(tag.value_at, wide);
    tags.push_back(tag);
  }
  return tags;
}

std::optional<TiffTags::Tag> TiffTags::find(unsigned tag, std::optional<std::uint64_t> directory) const {
  for (const Tag& each : tags(directory))
    if (each.tag == tag) return each;
  return std::nullopt;
}

std::span<const std::uint8_t> TiffTags::bytes_of(const Tag& tag) const {
  if (tag.value_at > bytes_.size()) return {};
  return bytes_.subspan(tag.value_at, std::min(length_of(tag), bytes_.size() - tag.value_at));
}

std::uint64_t TiffTags::length_of(const Tag& tag) {
  const std::uint64_t size = size_of(tag.type);
  return size > 0 && tag.count > ~std::uint64_t{0} / size ? ~std::uint64_t{0} : tag.count * size;
}

std::uint64_t TiffTags::number(const Tag& tag, std::uint64_t i) const {
  const std::uint64_t size = size_of(tag.type);
  return i < tag.count && i < bytes_.size() && tag.value_at <= bytes_.size()
             ? read(tag.value_at + i * size, static_cast<int>(size))
             : 0;
}

std::uint64_t TiffTags::number(unsigned tag, std::uint64_t otherwise) const {
  const std::optional<Tag> found = find(tag);
  return found ? number(*found) : otherwise;
}

std::uint64_t TiffTags::read(std::uint64_t at, int count) const {
  if (at > bytes_.size() || bytes_.size() - at < static_cast<std::uint64_t>(count)) return 0;
  std::uint64_t value = 0;
  for (int i = 0; i < count; ++i)
    value |= std::uint64_t{bytes_[at + static_cast<std::uint64_t>(i)]} << 8 * (little_ ? i : count - 1 - i);
  return value;
}

}  // namespace freshet::media
