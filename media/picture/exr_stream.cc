#include "media/picture/exr_stream.h"

#include <exception>

#include <ImfOutputFile.h>
#include <ImfStdIO.h>
#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::media {
namespace {

void require_size(const Imf::Header& header, std::size_t bytes, std::int64_t most, const std::string& where) {
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  // No coding of OpenEXR's packs a thousand samples into a byte; a few bytes can claim gigabytes.
  if (width < 1 || height < 1 || width > most || height > most || width * height > most ||
      width * height > 1024 * static_cast<std::int64_t>(bytes))
    throw Error(ErrorKind::kInput, where,
                fmt::format("it claims {} x {} pixels, and has {} bytes", width, height, bytes),
                fmt::format("Write it again, with at most {} pixels", most));
}

}  // namespace

void read_exr(const std::vector<std::uint8_t>& bytes, const std::string& where, std::int64_t most,
              const std::function<void(Imf::InputFile&)>& read) {
  try {
    Imf::StdISStream stream;
    stream.str({bytes.begin(), bytes.end()});
    Imf::InputFile file(stream, 0);
    require_size(file.header(), bytes.size(), most, where);
    read(file);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::kInput, where, std::string("OpenEXR cannot read it (") + fault.what() + ")",
                "Write it again");
  }
}

char* exr_origin(const cv::Mat& plane, const Imf::InputFile& file) {
  const Imath::V2i& first = file.header().dataWindow().min;
  return reinterpret_cast<char*>(plane.data) -
         std::int64_t{first.y} * static_cast<std::int64_t>(plane.step[0]) -
         std::int64_t{first.x} * static_cast<std::int64_t>(plane.elemSize());
}

std::vector<std::uint8_t> encode_exr(const Imf::Header& header, const Imf::FrameBuffer& buffer,
                                     const std::string& where) {
  try {
    Imf::StdOSStream stream;
    {
      Imf::OutputFile file(stream, header, 0);
      file.setFrameBuffer(buffer);
      const Imath::Box2i window = header.dataWindow();
      file.writePixels(window.max.y - window.min.y + 1);
    }
    const std::string text = stream.str();
    return {text.begin(), text.end()};
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::kIo, where, std::string("OpenEXR cannot encode it (") + fault.what() + ")");
  }
}

}  // namespace freshet::media
