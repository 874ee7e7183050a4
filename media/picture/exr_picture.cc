#include "media/picture/exr_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <span>
#include <string>
#include <utility>

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/picture/exr_stream.h"
#include "media/picture/motion_file.h"
#include "media/picture/picture_file.h"

namespace freshet::media {
namespace {

bool has_colour(const Imf::ChannelList& channels) {
  return channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
}

bool alike(const Imath::V2f& a, const Imath::V2f& b) {
  return std::abs(a.x - b.x) < 2e-3f && std::abs(a.y - b.y) < 2e-3f;
}

bool rec_709(const Imf::Chromaticities& of) {
  const Imf::Chromaticities known;  // which are Rec. 709's
  return alike(of.red, known.red) && alike(of.green, known.green) && alike(of.blue, known.blue) &&
         alike(of.white, known.white);
}

void require_ours(const Imf::Header& header, const std::string& where) {
  if (header.dataWindow() != header.displayWindow())
    throw Error(ErrorKind::kInput, where, "its data window is not its display window",
                "Write the whole picture, without overscan and not cropped");
  if (Imf::hasChromaticities(header) && !rec_709(Imf::chromaticities(header)))
    throw Error(ErrorKind::kInput, where, "its primaries are not those of Rec. 709 (sRGB), which we work in",
                "Convert it to linear Rec. 709");
  const Imf::ChannelList& channels = header.channels();
  if (!has_colour(channels) && !channels.findChannel("Y"))
    throw Error(ErrorKind::kInput, where, "it has no channels R, G and B, and no Y",
                "Write the picture's colours as R, G and B");
  for (const char* name : {"R", "G", "B", "Y", "A"})
    if (const Imf::Channel* channel = channels.findChannel(name);
        channel && (channel->xSampling != 1 || channel->ySampling != 1))
      throw Error(ErrorKind::kInput, where,
                  std::string("channel ") + name + " has not a sample for every pixel",
                  "Write it as RGB, not as luminance and chroma");
}

ExrPicture read_planes(Imf::InputFile& file) {
  const Imath::Box2i window = file.header().dataWindow();
  const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
  const Imf::ChannelList& channels = file.header().channels();
  ExrPicture picture{.light = cv::Mat(height, width, CV_32FC3, cv::Scalar::all(0)), .alpha = {}};
  Imf::FrameBuffer buffer;
  const auto slice = [&](const char* name, const cv::Mat& to, int channel) {
    buffer.insert(name,
                  Imf::Slice(Imf::FLOAT, exr_origin(to, file) + channel * static_cast<int>(sizeof(float)),
                             to.elemSize(), to.step[0]));
  };
  cv::Mat grey;
  if (has_colour(channels)) {
    slice("B", picture.light, 0);
    slice("G", picture.light, 1);
    slice("R", picture.light, 2);
  } else {
    grey = cv::Mat(height, width, CV_32F, cv::Scalar(0));
    slice("Y", grey, 0);
  }
  if (channels.findChannel("A")) {
    picture.alpha = cv::Mat(height, width, CV_32F, cv::Scalar(0));
    slice("A", picture.alpha, 0);
  }
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  if (!grey.empty()) cv::merge(std::vector<cv::Mat>(3, grey), picture.light);
  return picture;
}

/// Header and samples of a layer; borrows `light` where it is written as it is.
struct EncodedLayer {
  /// before   what its channels' names begin with.
  EncodedLayer(const std::filesystem::path& path, const cv::Mat& light, ExrSamples samples,
               const std::string& before)
      : header(std::max(1, light.cols), std::max(1, light.rows)) {
    if (light.empty() || light.depth() != CV_32F || (light.channels() != 3 && light.channels() != 4))
      throw Error(ErrorKind::kUsage, path.string(), "an EXR is written of 32-bit BGR or BGRA");
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());
    static constexpr std::array kNames{"B", "G", "R", "A"};
    insert(light, samples, before, std::span(kNames).first(static_cast<std::size_t>(light.channels())));
  }
  /// motion   CV_32FC2, y down.
  void add_motion(const cv::Mat& motion, ExrSamples samples, const std::string& before) {
    upwards = with_y_turned(motion);
    static constexpr std::array kNames{kMotionX, kMotionY};
    insert(upwards, samples, before, kNames);
  }

  Imf::Header header;
  Imf::FrameBuffer buffer;

 private:
  void insert(const cv::Mat& values, ExrSamples samples, const std::string& before,
              std::span<const char* const> names) {
    const bool small = samples == ExrSamples::kHalf;
    const Imf::PixelType type = small ? Imf::HALF : Imf::FLOAT;
    const std::size_t row = names.size() * static_cast<std::size_t>(values.cols);
    std::vector<half>& kept = halves.emplace_back(small ? row * static_cast<std::size_t>(values.rows) : 0);
    for (int y = 0; small && y < values.rows; ++y)
      for (std::size_t i = 0; i < row; ++i)
        kept[static_cast<std::size_t>(y) * row + i] = half(values.ptr<float>(y)[i]);
    char* const data = small ? reinterpret_cast<char*>(kept.data()) : reinterpret_cast<char*>(values.data);
    const std::size_t sample = small ? sizeof(half) : sizeof(float);
    const std::size_t row_bytes = small ? row * sample : values.step[0];
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string name = before + names[i];
      header.channels().insert(name, Imf::Channel(type));
      buffer.insert(name, Imf::Slice(type, data + i * sample, names.size() * sample, row_bytes));
    }
  }

  std::deque<std::vector<half>> halves;  // of the light, then of the motion
  cv::Mat upwards;
};

}  // namespace

ExrPicture decode_exr_picture(const std::vector<std::uint8_t>& bytes, const std::filesystem::path& where) {
  ExrPicture picture;
  read_exr(bytes, where.string(), kMaxPicturePixels, [&](Imf::InputFile& file) {
    require_ours(file.header(), where.string());
    picture = read_planes(file);
  });
  if (!cv::checkRange(picture.light))
    throw Error(ErrorKind::kInput, where.string(), "some of its values are infinite or no numbers",
                "Clamp it, and write it again");
  return picture;
}

void write_exr_picture(const std::filesystem::path& path, const cv::Mat& light, ExrSamples samples) {
  const EncodedLayer layer(path, light, samples, "");
  write_bytes(path, encode_exr(layer.header, layer.buffer, path.string()));
}

void write_exr_parts(const std::filesystem::path& path, std::span<const ExrPart> parts, ExrSamples samples) {
  std::deque<EncodedLayer> layers;
  for (const ExrPart& part : parts) {
    const std::string before = layers.empty() ? "" : part.name + ".";
    EncodedLayer& layer = layers.emplace_back(path, part.light, samples, before);
    layer.header.setName(part.name);
    if (!part.motion.empty()) layer.add_motion(part.motion, samples, before);
  }
  std::vector<Imf::Header> headers;
  std::vector<Imf::FrameBuffer> buffers;
  for (const EncodedLayer& layer : layers) {
    headers.push_back(layer.header);
    buffers.push_back(layer.buffer);
  }
  write_bytes(path, encode_exr_parts(std::move(headers), buffers, path.string()));
}

void write_exr_depth(const std::filesystem::path& path, const cv::Mat& depth) {
  if (depth.empty() || depth.type() != CV_32F)
    throw Error(ErrorKind::kUsage, path.string(), "depth is written of one 32-bit channel");
  Imf::Header header(depth.cols, depth.rows);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  Imf::FrameBuffer buffer;
  buffer.insert("Z",
                Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(depth.data), sizeof(float), depth.step[0]));
  write_bytes(path, encode_exr(header, buffer, path.string()));
}

}  // namespace freshet::media
