// media/picture/picture_file.h — a picture file's bytes: read, encoded, written. Private to this room.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::media {

/// The whole file. Throws Error{kInput}: missing, not a file, empty, above 2 GiB, unreadable.
std::vector<std::uint8_t> read_bytes(const std::filesystem::path& path);

/// Encodes by the name's ending. Throws Error{kUsage} for an unknown ending or a picture that the format
/// cannot hold (depth, channels, size).
std::vector<std::uint8_t> encode_picture(const std::filesystem::path& path, const cv::Mat& picture);

/// A name beside `path`, with its ending, that no other writer uses; the file does not exist yet.
std::filesystem::path temporary_beside(const std::filesystem::path& path);
/// Throws Error{kIo} when the folder of `path` does not exist.
void require_folder_of(const std::filesystem::path& path);
/// Writes under a temporary name and renames. Throws Error{kIo}; leaves no partial file behind.
void write_bytes(const std::filesystem::path& path, const std::vector<std::uint8_t>& bytes);
/// Renames over the target. Throws Error{kIo} after removing `temporary`.
void move_into_place(const std::filesystem::path& temporary, const std::filesystem::path& path);

}  // namespace freshet::media
