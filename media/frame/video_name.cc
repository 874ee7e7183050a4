#include "media/frame/video_name.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "platform/text.h"

namespace freshet::media {

bool looks_like_video(const std::filesystem::path& path) {
  static constexpr std::array<std::string_view, 32> kEndings = {
      ".mp4",  ".m4v", ".mov",  ".mkv", ".webm", ".avi",  ".mpg", ".mpeg", ".m2v",  ".ts",   ".mts",
      ".m2ts", ".wmv", ".asf",  ".flv", ".ogv",  ".ogg",  ".3gp", ".3g2",  ".mxf",  ".vob",  ".dv",
      ".y4m",  ".gif", ".apng", ".ivf", ".nut",  ".h264", ".264", ".h265", ".hevc", ".mjpeg"};
  const std::string ending = lower_ending(path);
  return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace freshet::media
