#include "media/picture/exr_picture.h"

#include <array>
#include <cmath>
#include <string>

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStdIO.h>
#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/picture_file.h"

namespace freshet::media {
namespace {

constexpr std::int64_t kMaxPixels = std::int64_t{1} << 28;

bool alike(const Imath::V2f& a, const Imath::V2f& b) {
  return std::abs(a.x - b.x) < 2e-3f && std::abs(a.y - b.y) < 2e-3f;
}

bool rec_709(const Imf::Chromaticities& of) {
  const Imf::Chromaticities known;  // which are Rec. 709's
  return alike(of.red, known.red) && alike(of.green, known.green) && alike(of.blue, known.blue) &&
         alike(of.white, known.white);
}

void require_readable(const Imf::Header& header, std::size_t bytes, const std::string& where) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  // No coding of OpenEXR's packs a thousand samples into a byte; a few bytes can claim gigabytes.
  if (width < 1 || height < 1 || width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels ||
      width * height > 1024 * static_cast<std::int64_t>(bytes))
    throw Error(ErrorKind::kInput, where,
                fmt::format("it claims {} x {} pixels, and has {} bytes", width, height, bytes),
                "Write it again, below 2^28 pixels");
  if (window != header.displayWindow())
    throw Error(ErrorKind::kInput, where, "its data window is not its display window",
                "Write the whole picture, without overscan and not cropped");
  if (Imf::hasChromaticities(header) && !rec_709(Imf::chromaticities(header)))
    throw Error(ErrorKind::kInput, where, "its primaries are not those of Rec. 709 (sRGB), which we work in",
                "Convert it to linear Rec. 709");
}

}  // namespace

ExrPicture decode_exr_picture(const std::vector<std::uint8_t>& bytes, const std::filesystem::path& where) {
  try {
    Imf::StdISStream stream;
    stream.str({bytes.begin(), bytes.end()});
    Imf::InputFile file(stream, 0);
    require_readable(file.header(), bytes.size(), where.string());
    const Imath::Box2i window = file.header().dataWindow();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    const Imf::ChannelList& channels = file.header().channels();
    const bool colour = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    if (!colour && !channels.findChannel("Y"))
      throw Error(ErrorKind::kInput, where.string(), "it has no channels R, G and B, and no Y",
                  "Write the picture's colours as R, G and B");
    for (const char* name : {"R", "G", "B", "Y", "A"})
      if (const Imf::Channel* channel = channels.findChannel(name);
          channel && (channel->xSampling != 1 || channel->ySampling != 1))
        throw Error(ErrorKind::kInput, where.string(),
                    std::string("channel ") + name + " has not a sample for every pixel",
                    "Write it as RGB, not as luminance and chroma");
    ExrPicture picture{.light = cv::Mat(height, width, CV_32FC3, cv::Scalar::all(0)), .alpha = {}};
    Imf::FrameBuffer buffer;
    const auto slice = [&](const char* name, cv::Mat& to, int channel) {
      // OpenEXR counts from the data window's origin.
      char* const origin = reinterpret_cast<char*>(to.data) + channel * static_cast<int>(sizeof(float)) -
                           std::int64_t{window.min.y} * static_cast<std::int64_t>(to.step[0]) -
                           std::int64_t{window.min.x} * static_cast<std::int64_t>(to.elemSize());
      buffer.insert(name, Imf::Slice(Imf::FLOAT, origin, to.elemSize(), to.step[0]));
    };
    cv::Mat grey;
    if (colour) {
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
    if (!colour) cv::merge(std::vector<cv::Mat>(3, grey), picture.light);
    if (!cv::checkRange(picture.light))
      throw Error(ErrorKind::kInput, where.string(), "some of its values are infinite or no numbers",
                  "Clamp it, and write it again");
    return picture;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::kInput, where.string(),
                std::string("OpenEXR cannot read it (") + fault.what() + ")", "Write it again");
  }
}

void write_exr_picture(const std::filesystem::path& path, const cv::Mat& light, ExrSamples samples) {
  if (light.empty() || light.depth() != CV_32F || (light.channels() != 3 && light.channels() != 4))
    throw Error(ErrorKind::kUsage, path.string(), "an EXR is written of 32-bit BGR or BGRA");
  const bool small = samples == ExrSamples::kHalf;
  const Imf::PixelType type = small ? Imf::HALF : Imf::FLOAT;
  const std::size_t channels = static_cast<std::size_t>(light.channels());
  const std::size_t row = channels * static_cast<std::size_t>(light.cols);
  std::vector<half> halves;
  if (small) halves.resize(row * static_cast<std::size_t>(light.rows));
  for (int y = 0; small && y < light.rows; ++y)
    for (std::size_t i = 0; i < row; ++i)
      halves[static_cast<std::size_t>(y) * row + i] = half(light.ptr<float>(y)[i]);
  char* const data = small ? reinterpret_cast<char*>(halves.data()) : reinterpret_cast<char*>(light.data);
  const std::size_t sample = small ? sizeof(half) : sizeof(float);
  const std::size_t row_bytes = small ? row * sample : light.step[0];
  try {
    Imf::Header header(light.cols, light.rows);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());
    Imf::FrameBuffer buffer;
    static constexpr std::array kNames{"B", "G", "R", "A"};
    for (std::size_t i = 0; i < channels; ++i) {
      header.channels().insert(kNames[i], Imf::Channel(type));
      buffer.insert(kNames[i], Imf::Slice(type, data + i * sample, channels * sample, row_bytes));
    }
    Imf::StdOSStream stream;
    {
      Imf::OutputFile file(stream, header, 0);
      file.setFrameBuffer(buffer);
      file.writePixels(light.rows);
    }
    const std::string text = stream.str();
    write_bytes(path, {text.begin(), text.end()});
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::kIo, path.string(),
                std::string("OpenEXR cannot encode it (") + fault.what() + ")");
  }
}

}  // namespace freshet::media
