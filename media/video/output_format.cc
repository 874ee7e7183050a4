#include "media/video/output_format.h"

#include <string>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/picture/light.h"
#include "media/picture/picture_sequence.h"

namespace freshet::media {
namespace {

bool is_film(const FileFormat& format) { return format.kind == FormatKind::kFilm; }
bool is_picture(const FileFormat& format) { return format.kind == FormatKind::kPicture; }

// sRGB code of 8 or 16 bits as linear light, times alpha.
cv::Mat light_of(const cv::Mat& picture) {
  cv::Mat values, alpha;
  picture.convertTo(values, CV_32F, picture.depth() == CV_8U ? 1.0 / 255 : 1.0 / 65535);
  if (values.channels() == 4) {
    cv::extractChannel(values, alpha, 3);
    cv::cvtColor(values, values, cv::COLOR_BGRA2BGR);
  }
  cv::Mat light = to_linear(values);
  if (alpha.empty()) return light;
  cv::Mat colours;
  cv::merge(std::vector<cv::Mat>(3, alpha), colours);
  cv::multiply(light, colours, light);
  cv::cvtColor(light, light, cv::COLOR_BGR2BGRA);
  cv::insertChannel(alpha, light, 3);
  return light;
}

}  // namespace

std::string OutputFormat::depths_text() const {
  return std::string(file_->codec) + " has " + file_->depths.text() + (light() ? "" : " bits");
}

Samples OutputFormat::samples(int bits) const {
  if (light()) return Samples::kLight;
  const bool deep = holds(Depth::k16) || !holds(Depth::k8) || (bits == 10 && holds(Depth::k10));
  return deep ? Samples::k16 : Samples::k8;
}

OutputFormat output_format(const std::filesystem::path& path, int frames) {
  const bool sequence = is_pattern(path);
  const FileFormat* picture = sequence || frames == 1 ? find_format(path, FormatKind::kPicture) : nullptr;
  if (picture != nullptr && picture->coding != Coding::kNone)
    return {*picture, sequence ? OutputFormat::Form::kSequence : OutputFormat::Form::kPicture};
  if (sequence)
    throw Error(ErrorKind::kUsage, path.string(),
                "the ending \"" + path.extension().string() + "\" is no picture format that is written",
                "For a sequence use " + written_endings(is_picture));
  const FileFormat* film = find_format(path, FormatKind::kFilm);
  if (film == nullptr || film->coding == Coding::kNone)
    throw Error(ErrorKind::kUsage, path.string(),
                "the ending \"" + path.extension().string() + "\" names no video format that is written",
                "Use " + written_endings(is_film) + "; or a pattern such as frame%05d.png");
  return {*film, OutputFormat::Form::kFilm};
}

cv::Mat as_held(const cv::Mat& picture, const OutputFormat& format, int bits) {
  if (picture.depth() != CV_8U && picture.depth() != CV_16U) return picture;
  if (format.light()) return light_of(picture);
  if (picture.depth() == CV_8U || format.samples(bits) != Samples::k8) return picture;
  cv::Mat narrow;
  picture.convertTo(narrow, CV_8U, 1.0 / 257);
  return narrow;
}

}  // namespace freshet::media
