// media/frame/file_format.h — what a name's ending says: which format it is, and what a file of it holds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>

namespace freshet::media {

/// Bits of a channel's samples, in the words of --depth: 8, 10, 16 of sRGB code; half and float of linear light.
enum class Depth : std::uint8_t { k8, k10, k16, kHalf, kFloat };
std::string_view to_string(Depth depth);

class Depths {
 public:
  constexpr Depths() = default;
  constexpr Depths(std::initializer_list<Depth> depths) {
    for (const Depth each : depths) bits_ |= bit(each);
  }
  constexpr bool has(Depth depth) const { return (bits_ & bit(depth)) != 0; }
  /// "8 or 16"
  std::string text() const;

 private:
  static constexpr unsigned bit(Depth depth) { return 1u << static_cast<unsigned>(depth); }
  unsigned bits_ = 0;
};
inline constexpr Depth kDepths[] = {Depth::k8, Depth::k10, Depth::k16, Depth::kHalf, Depth::kFloat};

/// How frames are coded where they are written.
enum class Coding {
  kNone,     // it is read, and not written
  kPicture,  // by OpenCV
  kExr,
  kH264,
  kFfv1,
  kProRes,  // 4444
  kWebp,    // animated
  kApng,
  kGif,  // one palette for all frames
};

enum class FormatKind { kFilm, kPicture };

/// A row of the table. An ending that is both a film's and a picture's (.png, .webp) has two.
struct FileFormat {
  std::string_view ending;  // lower case, with its dot
  FormatKind kind = FormatKind::kFilm;
  Coding coding = Coding::kNone;
  Depths depths = {};  // that are written
  bool alpha = false;  // is written
  std::string_view codec = {};
  std::string_view name = {}, use = {};  // for a person who chooses one; empty: not offered in the studio
  int max_side = std::numeric_limits<std::uint16_t>::max();  // px
};

/// All endings that are read or written. The first row of an ending is what it means to who names no number of frames.
std::span<const FileFormat> file_formats();
/// By the name's ending, in any case; null where the kind has no such ending.
const FileFormat* find_format(const std::filesystem::path& path, FormatKind kind);
/// Endings of rows that are written and wanted, each once, as a sentence lists them: ".mp4, .mov or .mkv".
std::string written_endings(const std::function<bool(const FileFormat&)>& wanted);

/// Whether a name of which nothing more is said stands for a picture a frame, by the ending's first row.
bool means_sequence(const std::filesystem::path& path);

/// Whether it is read as a picture.
bool looks_like_picture(const std::filesystem::path& path);
/// Whether a folder walk should try to read it as a clip. Endings of films and pictures are pictures.
bool looks_like_video(const std::filesystem::path& path);

}  // namespace freshet::media
