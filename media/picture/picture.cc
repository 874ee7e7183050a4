#include "media/picture/picture.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <string_view>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/frame/file_format.h"
#include "media/picture/colour_profile.h"
#include "media/picture/exr_picture.h"
#include "media/picture/exr_stream.h"
#include "media/picture/light.h"
#include "media/picture/picture_bounds.h"
#include "media/picture/picture_file.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

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

bool is_exr(const std::vector<std::uint8_t>& bytes) {
  return bytes.size() > 4 && std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) == 0;
}

// The file's bytes, as far as they can be borne.
std::vector<std::uint8_t> bytes_of(const fs::path& path) {
  std::vector<std::uint8_t> bytes = read_bytes(path);
  if (is_exr(bytes)) {
    require_bounded_exr(bytes, path.string(), kMaxPicturePixels);
    return bytes;
  }
  if (!claimed_size(bytes) && looks_like_video(path))
    throw Error(
        ErrorKind::kInput, path.string(), "a video, where a picture is expected",
        "Take a frame of it, for example ffmpeg -ss 1 -i " + path.string() + " -frames:v 1 still.png");
  return bounded_picture(std::move(bytes), path.string());
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
  if (std::int64_t{samples.cols} * samples.rows > kMaxPicturePixels)
    throw Error(ErrorKind::kInput, name, "is above 2^28 pixels", "Reduce it");
  return samples;
}

std::vector<std::uint8_t> profile_of(const AVFrame* frame, const std::vector<std::uint8_t>& bytes) {
  if (frame == nullptr) return tiff_profile(bytes);
  const AVFrameSideData* data = av_frame_get_side_data(frame, AV_FRAME_DATA_ICC_PROFILE);
  if (data == nullptr) return {};
  return {data->data, data->data + data->size};
}

// The way up that makes `from` the upright picture: OpenCV turns a picture by its EXIF data only where it drops alpha.
cv::Mat turned(const cv::Mat& from, int way) {
  cv::Mat out = from.clone();
  if (way & 4) cv::transpose(out, out);
  if (way & 1) cv::flip(out, out, 1);
  if (way & 2) cv::flip(out, out, 0);
  return out;
}

// CV_8U, upright; empty where it is opaque everywhere. colour   of the same file, upright.
cv::Mat alpha_of(const std::vector<std::uint8_t>& bytes, const fs::path& path, const cv::Mat& colour) {
  cv::Mat whole = decode_with_opencv(path, bytes, cv::IMREAD_UNCHANGED);
  if (whole.channels() != 4) return {};
  cv::Mat alpha, bgr;
  cv::extractChannel(whole, alpha, 3);
  cv::cvtColor(whole, bgr, cv::COLOR_BGRA2BGR);
  int way = bgr.size() == colour.size() ? 0 : 4;
  for (int each = 0; each < 8; ++each)
    if (const cv::Mat upright = turned(bgr, each); upright.size() == colour.size() &&
                                                   upright.type() == colour.type() &&
                                                   cv::norm(upright, colour, cv::NORM_INF) == 0) {
      way = each;
      break;
    }
  alpha = turned(alpha, way);
  if (alpha.depth() == CV_16U)
    alpha.convertTo(alpha, CV_8U, 1.0 / 257);
  else if (alpha.depth() != CV_8U)
    alpha.convertTo(alpha, CV_8U, 255);
  return cv::countNonZero(alpha != 255) == 0 ? cv::Mat() : alpha;
}

// Values as the file has them, without a look at its colour profile.
struct Decoded {
  cv::Mat colour;  // CV_8UC3, CV_16UC3, or CV_32FC3: linear light of an EXR, sRGB code else
  cv::Mat alpha;   // CV_8U; empty: opaque
  std::vector<std::uint8_t> profile;
  bool light = false;
};

Decoded decode(const fs::path& path) {
  const std::vector<std::uint8_t> bytes = bytes_of(path);
  Decoded decoded;
  if (is_exr(bytes)) {
    ExrPicture exr = decode_exr_picture(bytes, path);
    decoded.colour = exr.light;
    decoded.light = true;
    if (!exr.alpha.empty()) {
      exr.alpha.convertTo(decoded.alpha, CV_8U, 255);
      if (cv::countNonZero(decoded.alpha != 255) == 0) decoded.alpha.release();
    }
    return decoded;
  }
  const AvOwner<AVFrame> frame = decode_strictly(path, bytes);
  decoded.colour = decode_with_opencv(path, bytes, cv::IMREAD_COLOR | cv::IMREAD_ANYDEPTH);
  if (has_alpha(frame.get(), bytes)) decoded.alpha = alpha_of(bytes, path, decoded.colour);
  decoded.profile = profile_of(frame.get(), bytes);
  return decoded;
}

// 8 bits of sRGB code.
cv::Mat reduced(const Decoded& decoded) {
  cv::Mat bgr;
  if (decoded.colour.depth() == CV_8U) return decoded.colour;
  if (decoded.colour.depth() == CV_16U)
    decoded.colour.convertTo(bgr, CV_8U, 1.0 / 257);
  else
    cv::Mat(decoded.light ? to_coded(decoded.colour) : decoded.colour).convertTo(bgr, CV_8U, 255);
  return bgr;
}

std::string reduction_of(const Decoded& decoded) {
  if (decoded.colour.depth() == CV_8U) return {};
  if (decoded.colour.depth() == CV_16U) return "16 bits per channel reduced to 8";
  return "floating point reduced to 8 bits, values above 1 cut off";
}

// A matte of grey; what is coloured is told.
cv::Mat grey_of(const Decoded& decoded, const fs::path& path, std::vector<std::string>& notices) {
  constexpr int kTint = 24;              // of what is a little off grey
  constexpr double kMaxColoured = 0.02;  // of the pixels: a matte saved as JPEG has less
  // A matte's numbers are how much is fluid, whatever curve its kind of file has.
  Decoded plain = decoded;
  plain.light = false;
  const cv::Mat bgr = reduced(plain);
  if (std::string said = reduction_of(decoded); !said.empty()) notices.push_back(std::move(said));
  std::vector<cv::Mat> channels;
  cv::split(bgr, channels);
  const cv::Mat most = cv::max(cv::max(channels[0], channels[1]), channels[2]);
  const cv::Mat least = cv::min(cv::min(channels[0], channels[1]), channels[2]);
  if (cv::countNonZero(most != least) == 0) return channels[0];
  const double coloured = cv::countNonZero(most - least > kTint) / static_cast<double>(bgr.total());
  if (coloured > kMaxColoured)
    throw Error(ErrorKind::kInput, path.string(),
                std::to_string(std::lround(100 * coloured)) + " % of it is in colour: a picture, not a matte",
                "Give a grey one, white where the fluid is and black elsewhere");
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  notices.emplace_back("colour reduced to grey");
  return grey;
}

std::string percent(double fraction) {
  const double value = 100 * fraction;
  return (value < 1 ? std::string("less than 1") : std::to_string(std::lround(value))) + " %";
}

constexpr int kLeast = 8;  // of a matte's 255

// Brought to the picture's size; nothing in it below kLeast; what cannot be meant is told.
Matte fitted_matte(Matte matte, cv::Size size, const fs::path& path) {
  constexpr int kGreyNothing = 128;
  constexpr double kFlat = 0.2, kHardly = 0.01;  // of the pixels
  const auto refuse = [&](const std::string& fault, const std::string& remedy) {
    throw Error(ErrorKind::kInput, path.string(), fault, remedy);
  };
  cv::Mat& alpha = matte.alpha;
  if (alpha.size() != size) {
    const auto text = [](cv::Size of) {
      return std::to_string(of.width) + " x " + std::to_string(of.height);
    };
    if (!has_shape_of(alpha.size(), size))
      refuse("the matte is " + text(alpha.size()) + ", the picture " + text(size) + ": another shape",
             "Crop them alike");
    matte.notices.push_back("the matte is " + text(alpha.size()) + ", and is scaled to the picture's " +
                            text(size));
    scale_matte(alpha, size);
  }
  std::array<int, 256> count{};
  for (int y = 0; y < alpha.rows; ++y)
    for (int x = 0; x < alpha.cols; ++x) ++count[alpha.at<std::uint8_t>(y, x)];
  const double all = static_cast<double>(alpha.total());
  const int black = std::accumulate(count.begin(), count.begin() + kLeast, 0);
  if (black == static_cast<int>(alpha.total()))
    refuse("the matte is black everywhere, so nothing in it is fluid", "Paint the fluid white");
  if (count[255] == static_cast<int>(alpha.total()))
    refuse("the matte is white everywhere", "Paint black what stands still, or say --whole instead of it");
  const int flattest = static_cast<int>(
      std::max_element(count.begin() + kLeast, count.begin() + kGreyNothing) - count.begin());
  if (black < kHardly * all && count[flattest] > kFlat * all)
    refuse((black == 0 ? "the matte has no black" : "the matte has hardly any black") + std::string(": ") +
               percent(count[flattest] / all) + " of it is the grey " + std::to_string(flattest) +
               " of 255, and would move",
           "Paint black what stands still");
  // A soft matte that goes on beyond the picture's edge may well have none.
  if (black == 0) matte.notices.push_back("the matte has no black: nothing stands quite still");
  if (const int faint = black - count[0]; faint > kHardly * all)
    matte.notices.push_back(percent(faint / all) + " of it is nearly black (below " + std::to_string(kLeast) +
                            " of 255) and stands still");
  settle_dark(alpha);
  return matte;
}

}  // namespace

void scale_matte(cv::Mat& alpha, cv::Size size) {
  if (alpha.size() == size) return;
  cv::resize(alpha, alpha, size, 0, 0, alpha.cols > size.width ? cv::INTER_AREA : cv::INTER_LINEAR);
}

void settle_dark(cv::Mat& alpha) { alpha.setTo(0, alpha < kLeast); }

bool has_shape_of(cv::Size matte, cv::Size picture) {
  constexpr double kSameShape = 0.01;
  return std::abs(matte.aspectRatio() / picture.aspectRatio() - 1) <= kSameShape;
}

Still read_still(const fs::path& path) {
  Decoded decoded = decode(path);
  Still still;
  if (!decoded.profile.empty() && decoded.colour.depth() != CV_32F)
    if (std::string done = bring_to_srgb(decoded.profile, decoded.colour, path); !done.empty())
      still.notices.push_back(std::move(done));
  if (decoded.light) still.notices.emplace_back("taken as linear light, Rec. 709 (sRGB) primaries");
  still.bgr = reduced(decoded);
  still.reduction = reduction_of(decoded);
  still.alpha = decoded.alpha;
  if (decoded.colour.depth() == CV_16U || decoded.light) still.deep = decoded.colour;
  if (decoded.colour.depth() == CV_32F && !decoded.light) still.deep = to_linear(decoded.colour);
  return still;
}

cv::Mat coded_picture(const Still& still) {
  cv::Mat coded;
  if (still.deep.empty())
    still.bgr.convertTo(coded, CV_32F, 1.0 / 255);
  else if (still.deep.depth() == CV_16U)
    still.deep.convertTo(coded, CV_32F, 1.0 / 65535);
  else
    coded = to_coded(still.deep);
  return coded;
}

Picture read_picture(const fs::path& path) {
  Still still = read_still(path);
  if (!still.alpha.empty()) still.notices.emplace_back("alpha channel ignored");
  if (!still.reduction.empty()) still.notices.push_back(still.reduction);
  return {.bgr = std::move(still.bgr), .notices = std::move(still.notices)};
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

Matte read_grey(const fs::path& path) {
  const Decoded decoded = decode(path);
  Matte matte;
  if (!decoded.alpha.empty()) {
    matte.alpha = decoded.alpha;
    matte.notices.emplace_back("its alpha channel is the matte");
  } else {
    matte.alpha = grey_of(decoded, path, matte.notices);
  }
  return matte;
}

Matte read_matte(const fs::path& path, cv::Size size) { return fitted_matte(read_grey(path), size, path); }

Matte matte_of_alpha(const cv::Mat& alpha, const fs::path& path) {
  return fitted_matte({.alpha = alpha.clone(), .notices = {}}, alpha.size(), path);
}

void write_picture(const fs::path& path, const cv::Mat& picture) {
  write_bytes(path, encode_picture(path, picture));
}

void check_picture_name(const fs::path& path) {
  require_folder_of(path);
  encode_picture(path, cv::Mat::zeros(1, 1, CV_8UC3));
}

}  // namespace freshet::media
