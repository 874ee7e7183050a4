// media/picture/picture_sequence.h — the files of a numbered sequence or a folder of pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace freshet::media {

/// One file per frame, in order. `number` is the file's own in a pattern, its rank in a folder.
struct PictureSequence {
  std::vector<std::filesystem::path> files;
  std::vector<std::int64_t> numbers;
};

/// True when the name's last part holds exactly one %d, %Nd or %0Nd, or else one run of two or more #, which
/// stands for as many digits: f.####.png is f.%04d.png.
bool is_pattern(const std::filesystem::path& path);
/// The name of one file of a pattern.
std::filesystem::path numbered(const std::filesystem::path& pattern, std::int64_t number);

/// Files that match the pattern, by number, wherever it starts (film shots start at 1001).
/// Throws Error{kInput} when there are none.
PictureSequence list_pattern(const std::filesystem::path& pattern);
/// The same; empty when there are none, or no folder.
PictureSequence find_pattern(const std::filesystem::path& pattern);
/// Pictures of a folder in natural order ("f9.png" before "f10.png"); other files and folders are passed
/// over, and so are names that begin with a dot: some systems leave one beside each picture. Throws
/// Error{kInput} when there are none.
PictureSequence list_folder(const std::filesystem::path& folder);
/// The same of the files that are wanted, whatever they hold.
PictureSequence list_folder(const std::filesystem::path& folder,
                            bool (*wanted)(const std::filesystem::path&));

/// Name of the first file that a gap in the numbers leaves out, where all names are alike but for one number
/// that grows; nothing where there is no gap or the names are not numbered.
std::optional<std::filesystem::path> first_missing(const PictureSequence& sequence);

/// Runs of digits compare as numbers, all else byte by byte. A strict total order.
bool natural_less(std::string_view a, std::string_view b);

}  // namespace freshet::media
