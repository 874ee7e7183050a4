// media/picture/tiff_tags.h — the tags of a TIFF, classic or big, and of EXIF data, which are one. Private to this
// room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace freshet::media {

/// Nothing in the bytes is trusted: what would lie outside of them is not there. They must outlive this.
class TiffTags {
 public:
  struct Tag {
    unsigned tag = 0, type = 0;
    std::uint64_t count = 0;
    std::uint64_t value_at = 0;  // where its values lie
  };

  /// Of what is no TIFF there are no tags.
  explicit TiffTags(std::span<const std::uint8_t> bytes);

  /// Those of the directory at this place: the first, when it is left out.
  std::vector<Tag> tags(std::optional<std::uint64_t> directory = {}) const;
  std::optional<Tag> find(unsigned tag, std::optional<std::uint64_t> directory = {}) const;
  /// The tag's values as they lie, as many as there are bytes for.
  std::span<const std::uint8_t> bytes_of(const Tag& tag) const;
  /// How long the tag says they are.
  static std::uint64_t length_of(const Tag& tag);
  /// A whole number among them. 0: there is none.
  std::uint64_t number(const Tag& tag, std::uint64_t i = 0) const;
  /// The first of the tag's in the first directory.
  std::uint64_t number(unsigned tag, std::uint64_t otherwise = 0) const;

 private:
  std::uint64_t read(std::uint64_t at, int count) const;

  std::span<const std::uint8_t> bytes_;
  bool little_ = false, big_ = false, known_ = false;
};

}  // namespace freshet::media
