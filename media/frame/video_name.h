// media/frame/video_name.h — which names are videos'.
#pragma once

#include <filesystem>

namespace freshet::media {

/// True for names that a folder walk should try to read as a clip (by extension).
bool looks_like_video(const std::filesystem::path& path);

}  // namespace freshet::media
