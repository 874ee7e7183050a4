#include "media/picture/picture.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string_view>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/picture/picture_file.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

struct Decoded {
  cv::Mat colour;  // 3 channels of any depth, turned upright
  std::vector<std::string> notices;
};

// Formats that FFmpeg knows as well as OpenCV does.
bool ffmpeg_can_judge(const std::vector<std::uint8_t>& bytes) {
  const auto starts = [&](std::string_view magic) {
    return bytes.size() > 16 && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  };
  return starts("\x89PNG") || starts("\xFF\xD8") || starts("BM") || starts("RIFF");
}

// The picture as FFmpeg decodes it. Throws where it is damaged: OpenCV fills what a damaged file lacks and says so
// on stderr alone. Null for a format that FFmpeg cannot judge.
AvOwner<AVFrame> decode_strictly(const fs::path& path, const std::vector<std::uint8_t>& bytes) {
  if (!ffmpeg_can_judge(bytes)) return {};
  Decoder decoder(path, {.strict = true, .picture = true});
  AvOwner<AVFrame> frame = decoder.next();
  if (!frame || !decoder.fault().empty())
    throw Error(ErrorKind::kInput, path.string(),
                "the picture is damaged" + (decoder.fault().empty() ? "" : " (" + decoder.fault() + ")"),
                "Copy or download it again, or save it as PNG");
  return frame;
}

// Whether the file has alpha. OpenCV keeps alpha only where it ignores the EXIF orientation.
bool has_alpha(const AVFrame* frame, const std::vector<std::uint8_t>& bytes) {
  if (frame == nullptr) {
    try {
      return cv::imdecode(bytes, cv::IMREAD_UNCHANGED).channels() == 4;
    } catch (const cv::Exception&) {
      return false;
    }
  }
  if (frame->format == AV_PIX_FMT_PAL8) {  // alpha lies in the palette
    for (int i = 0; i < 256; ++i)
      if (frame->data[1][4 * i + 3] != 255) return true;
    return false;
  }
  return (av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame->format))->flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
}

// The file's bytes, after all that can be said without OpenCV: whether its size can be borne.
std::vector<std::uint8_t> bytes_of(const fs::path& path) {
  std::vector<std::uint8_t> bytes = read_bytes(path);
  if (const std::optional<cv::Size> size = claimed_size(bytes);
      size && std::int64_t{size->width} * size->height > kMaxPixels)
    throw Error(ErrorKind::kInput, path.string(),
                "is " + std::to_string(size->width) + " x " + std::to_string(size->height) + " pixels large",
                "Reduce it below 2^28 pixels");
  return bytes;
}

cv::Mat decode_with_opencv(const fs::path& path, const std::vector<std::uint8_t>& bytes, int flags) {
  const std::string name = path.string();
  cv::Mat samples;
  try {
    samples = cv::imdecode(bytes, flags);
  } catch (const cv::Exception& fault) {
    throw Error(ErrorKind::kInput, name, "cannot be decoded (" + fault.err + ")", "Save it again as PNG");
  }
  if (samples.empty())
    throw Error(ErrorKind::kInput, name, "not a picture that OpenCV can read",
                "Save it as PNG, JPEG or TIFF");
  if (std::int64_t{samples.cols} * samples.rows > kMaxPixels)
    throw Error(ErrorKind::kInput, name, "is above 2^28 pixels", "Reduce it");
  return samples;
}

Decoded decode(const fs::path& path) {
  const std::vector<std::uint8_t> bytes = bytes_of(path);
  Decoded decoded;
  if (has_alpha(decode_strictly(path, bytes).get(), bytes))
    decoded.notices.emplace_back("alpha channel ignored");
  decoded.colour = decode_with_opencv(path, bytes, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
  if (decoded.colour.depth() == CV_16U) {
    decoded.colour.convertTo(decoded.colour, CV_8U, 1.0 / 257);
    decoded.notices.emplace_back("16 bits per channel reduced to 8");
  } else if (decoded.colour.depth() != CV_8U) {
    decoded.colour.convertTo(decoded.colour, CV_8U, 255);
    decoded.notices.emplace_back("floating point reduced to 8 bits, values above 1 cut off");
  }
  return decoded;
}

}  // namespace

Picture read_picture(const fs::path& path) {
  Decoded decoded = decode(path);
  return {.bgr = std::move(decoded.colour), .notices = std::move(decoded.notices)};
}

DeepPicture read_deep_picture(const fs::path& path) {
  const std::vector<std::uint8_t> bytes = bytes_of(path);
  decode_strictly(path, bytes);
  cv::Mat samples = decode_with_opencv(path, bytes, cv::IMREAD_UNCHANGED);
  DeepPicture read;
  if (samples.depth() == CV_8U) {
    samples.convertTo(samples, CV_16U, 257);
  } else if (samples.depth() != CV_16U) {
    samples.convertTo(samples, CV_16U, 65535);
    read.notices.emplace_back("floating point reduced to 16 bits, values above 1 cut off");
  }
  if (samples.channels() == 1) cv::cvtColor(samples, samples, cv::COLOR_GRAY2BGRA);
  if (samples.channels() == 3) cv::cvtColor(samples, samples, cv::COLOR_BGR2BGRA);
  if (samples.channels() != 4)
    throw Error(ErrorKind::kInput, path.string(),
                "it has " + std::to_string(samples.channels()) + " channels", "Save it as PNG");
  std::vector<cv::Mat> channels;
  cv::split(samples, channels);
  read.grey = cv::norm(channels[0], channels[1], cv::NORM_INF) == 0 &&
              cv::norm(channels[1], channels[2], cv::NORM_INF) == 0;
  read.values = samples;
  return read;
}

Matte read_matte(const fs::path& path, cv::Size size) {
  Decoded decoded = decode(path);
  Matte matte;
  matte.notices = std::move(decoded.notices);
  if (decoded.colour.size() != size)
    throw Error(ErrorKind::kInput, path.string(),
                "the matte is " + std::to_string(decoded.colour.cols) + " x " +
                    std::to_string(decoded.colour.rows) + ", the picture " + std::to_string(size.width) +
                    " x " + std::to_string(size.height),
                "Make them equal in size");
  std::vector<cv::Mat> channels;
  cv::split(decoded.colour, channels);
  const bool grey = cv::norm(channels[0], channels[1], cv::NORM_INF) == 0 &&
                    cv::norm(channels[1], channels[2], cv::NORM_INF) == 0;
  if (grey) {
    matte.alpha = channels[0];
  } else {
    cv::cvtColor(decoded.colour, matte.alpha, cv::COLOR_BGR2GRAY);
    matte.notices.emplace_back("colour reduced to grey");
  }
  if (cv::countNonZero(matte.alpha) == 0)
    throw Error(ErrorKind::kInput, path.string(), "the matte is black everywhere, so nothing in it is fluid",
                "Paint the fluid white");
  return matte;
}

void write_picture(const fs::path& path, const cv::Mat& picture) {
  write_bytes(path, encode_picture(path, picture));
}

void check_picture_name(const fs::path& path) {
  require_folder_of(path);
  encode_picture(path, cv::Mat::zeros(1, 1, CV_8UC3));
}

}  // namespace freshet::media
