#include "media/frame/file_format.h"

#include <algorithm>
#include <array>
#include <vector>

#include "platform/text.h"

namespace freshet::media {
namespace {

using enum Depth;
using enum FormatKind;

constexpr FileFormat kFormats[] = {
    // clang-format off
    // Films that are written.
    {".mp4",  kFilm, Coding::kH264, {k8, k10}, false, "H.264", "MP4", "H.264, plays anywhere", 16384},  // libx264's
    {".webp", kFilm, Coding::kWebp, {k8}, true, "animated WebP", "WebP", "Animated picture, for sharing", 16383},
    {".gif",  kFilm, Coding::kGif, {k8}, false, "animated GIF", "GIF", "For where nothing else goes"},
    {".mov",  kFilm, Coding::kProRes, {k10}, true, "ProRes 4444", "ProRes", "10 bits, for editing"},
    {".mkv",  kFilm, Coding::kFfv1, {k8, k16}, true, "FFV1, lossless", "FFV1", "Lossless"},
    {".apng", kFilm, Coding::kApng, {k8}, true, "animated PNG"},
    // Pictures, and sequences of them.
    {".png",  kPicture, Coding::kPicture, {k8, k16}, true, "PNG", "PNG sequence", "A folder of pictures"},
    {".exr",  kPicture, Coding::kExr, {kHalf, kFloat}, true, "OpenEXR", "EXR sequence",
     "Linear light, for compositing"},
    {".tif",  kPicture, Coding::kPicture, {k8, k16}, true, "TIFF", "TIFF sequence", "A folder of pictures"},
    {".tiff", kPicture, Coding::kPicture, {k8, k16}, true, "TIFF"},
    {".jpg",  kPicture, Coding::kPicture, {k8}, false, "JPEG"},
    {".jpeg", kPicture, Coding::kPicture, {k8}, false, "JPEG"},
    {".bmp",  kPicture, Coding::kPicture, {k8}, false, "BMP"},
    {".webp", kPicture, Coding::kPicture, {k8}, true, "WebP"},
    {".ppm",  kPicture, Coding::kPicture, {k8, k16}, false, "PPM"},
    {".pgm",  kPicture}, {".pnm", kPicture}, {".dpx", kPicture}, {".jp2", kPicture}, {".sgi", kPicture},
    {".png",  kFilm, Coding::kApng, {k8}, true, "animated PNG"},
    // Films that are read.
    {".m4v"}, {".webm"}, {".avi"}, {".mpg"}, {".mpeg"}, {".m2v"}, {".ts"}, {".mts"}, {".m2ts"}, {".wmv"}, {".asf"},
    {".flv"}, {".ogv"}, {".ogg"}, {".3gp"}, {".3g2"}, {".mxf"}, {".vob"}, {".dv"}, {".y4m"}, {".ivf"}, {".nut"},
    {".h264"}, {".264"}, {".h265"}, {".hevc"}, {".mjpeg"},
    // clang-format on
};

std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

}  // namespace

std::string_view to_string(Depth depth) {
  static constexpr std::string_view kWords[] = {"8", "10", "16", "half", "float"};
  return kWords[static_cast<std::size_t>(depth)];
}

std::string Depths::text() const {
  std::vector<std::string> words;
  for (const Depth each : kDepths)
    if (has(each)) words.emplace_back(to_string(each));
  return listed(words);
}

std::span<const FileFormat> file_formats() { return kFormats; }

const FileFormat* find_format(const std::filesystem::path& path, FormatKind kind) {
  const std::string ending = lower_ending(path);
  const auto found = std::ranges::find_if(
      kFormats, [&](const FileFormat& each) { return each.kind == kind && each.ending == ending; });
  return found == std::end(kFormats) ? nullptr : &*found;
}

std::string written_endings(const std::function<bool(const FileFormat&)>& wanted) {
  std::vector<std::string> words;
  for (const FileFormat& each : kFormats)
    if (each.coding != Coding::kNone && wanted(each) && std::ranges::find(words, each.ending) == words.end())
      words.emplace_back(each.ending);
  return listed(words);
}

bool means_sequence(const std::filesystem::path& path) {
  const std::string ending = lower_ending(path);
  const auto first = std::ranges::find(kFormats, ending, &FileFormat::ending);
  return first != std::end(kFormats) && first->kind == kPicture;
}

bool looks_like_picture(const std::filesystem::path& path) { return find_format(path, kPicture) != nullptr; }

bool looks_like_video(const std::filesystem::path& path) {
  return find_format(path, kFilm) != nullptr && !looks_like_picture(path);
}

}  // namespace freshet::media
