// media/picture/capture_time.h — when a camera says that it took a picture.
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>

namespace freshet::media {

/// EXIF's DateTimeOriginal of a JPEG, PNG or TIFF, else its DateTime: the camera's own clock, in no known
/// zone. Nothing where there is none, or where it is broken: no picture is refused for it.
/// Throws   as read_picture where the file cannot be read.
std::optional<std::chrono::sys_seconds> capture_time(const std::filesystem::path& path);

}  // namespace freshet::media
