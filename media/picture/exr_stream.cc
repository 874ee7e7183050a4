#include "media/picture/exr_stream.h"

#include <algorithm>
#include <exception>
#include <string_view>
#include <utility>

#include <ImfMultiPartOutputFile.h>
#include <ImfOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <fmt/format.h>

#include "freshet/error.h"

namespace freshet::media {
namespace {

/// Reads the headers before OpenEXR does, which allocates for an attribute, a table or a tile what their numbers say.
class Headers {
 public:
  Headers(std::span<const std::uint8_t> bytes, std::int64_t most, std::string where)
      : bytes_(bytes), most_(most), where_(std::move(where)) {}

  void require_bounded() {
    constexpr std::uint64_t kMagic = 20000630, kTiled = 0x200, kOfParts = 0x1000;
    constexpr int kMaxParts = 1000;
    if (bytes_.size() < 8 || number(0, 4) != kMagic) return;  // which OpenEXR says itself
    const std::uint64_t flags = number(4, 4);
    at_ = 8;
    for (int part = 0;; ++part) {
      if (part == kMaxParts) refuse(fmt::format("it has more than {} parts", kMaxParts));
      if (part > 0 && number(at_, 1) == 0) return;
      require_bounded_part((flags & kTiled) != 0);
      if ((flags & kOfParts) == 0) return;
    }
  }

 private:
  [[noreturn]] void refuse(const std::string& fault) const {
    throw Error(ErrorKind::kInput, where_, fault,
                fmt::format("Write it again, with at most {} pixels", most_));
  }

  std::uint64_t number(std::size_t at, std::size_t count) const {
    if (at > bytes_.size() || bytes_.size() - at < count) refuse("its header is cut short");
    std::uint64_t value = 0;
    for (std::size_t i = count; i-- > 0;) value = value << 8 | bytes_[at + i];
    return value;
  }
  std::int64_t signed_number(std::size_t at) const {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(number(at, 4)));
  }
  std::string_view word() {
    const auto end = std::find(bytes_.begin() + static_cast<std::ptrdiff_t>(std::min(at_, bytes_.size())),
                               bytes_.end(), 0);
    if (end == bytes_.end()) refuse("its header is cut short");
    const auto length = static_cast<std::size_t>(end - bytes_.begin()) - at_;
    const std::string_view text(reinterpret_cast<const char*>(bytes_.data()) + at_, length);
    at_ += length + 1;
    return text;
  }

  void require_bounded_part(bool tiled) {
    constexpr std::int64_t kMaxRowsTogether = 256, kMaxLineBytes = std::int64_t{1} << 29,
                           kSmallTile = 1 << 20;
    const auto bytes = static_cast<std::int64_t>(bytes_.size());
    std::int64_t width = 0, height = 0, channels = 0, tile_width = 0, tile_height = 0;
    for (std::string_view name = word(); !name.empty(); name = word()) {
      const std::string_view type = word();
      const std::uint64_t length = number(at_, 4);
      at_ += 4;
      if (length > bytes_.size() - at_)
        refuse(fmt::format("its attribute \"{}\" claims {} bytes", name.substr(0, 100), length));
      const std::size_t end = at_ + length;
      if (name == "dataWindow") {
        width = signed_number(at_ + 8) - signed_number(at_) + 1;
        height = signed_number(at_ + 12) - signed_number(at_ + 4) + 1;
      } else if (type == "chlist") {
        for (; at_ < end && !word().empty(); at_ += 16) ++channels;
      } else if (type == "tiledesc") {
        tiled = true;
        tile_width = static_cast<std::int64_t>(number(at_, 4));
        tile_height = static_cast<std::int64_t>(number(at_ + 4, 4));
      } else if (name == "chunkCount" && signed_number(at_) > bytes / 8) {
        refuse(fmt::format("it claims {} chunks, and has {} bytes", signed_number(at_), bytes));
      } else if (type == "preview" && number(at_, 4) * number(at_ + 4, 4) * 4 + 8 != length) {
        refuse("its preview is damaged");
      } else if (type == "stringvector") {
        while (at_ + 4 <= end && number(at_, 4) <= end - at_ - 4) at_ += 4 + number(at_, 4);
        if (at_ != end) refuse("its attribute \"" + std::string(name.substr(0, 100)) + "\" is damaged");
      }
      at_ = end;
    }
    // No coding of OpenEXR's packs a thousand samples into a byte; a few bytes can claim gigabytes.
    if (width < 1 || height < 1 || width > most_ || height > most_ || width * height > most_ ||
        width * height > 1024 * bytes)
      refuse(fmt::format("it claims {} x {} pixels, and has {} bytes", width, height, bytes));
    if (channels * width * 4 * std::min(height, kMaxRowsTogether) > kMaxLineBytes)
      refuse(fmt::format("it has {} channels of {} x {} pixels", channels, width, height));
    // A table has eight bytes for each tile, or for as many rows as are packed together.
    if (!tiled && height / kMaxRowsTogether > bytes / 8)
      refuse(fmt::format("it claims {} rows, and has {} bytes", height, bytes));
    if (!tiled) return;
    if (tile_width < 1 || tile_height < 1 || tile_width > most_ || tile_height > most_ ||
        tile_width * tile_height > std::max(width * height, kSmallTile) ||
        ((width - 1) / tile_width + 1) * ((height - 1) / tile_height + 1) > bytes / 8)
      refuse(
          fmt::format("it claims tiles of {} x {} pixels, and has {} bytes", tile_width, tile_height, bytes));
  }

  std::span<const std::uint8_t> bytes_;
  std::int64_t most_ = 0;
  std::string where_;
  std::size_t at_ = 0;
};

int rows_of(const Imf::Header& header) { return header.dataWindow().max.y - header.dataWindow().min.y + 1; }

/// What `write` leaves in the stream, OpenEXR's faults as ours.
template <class Write>
std::vector<std::uint8_t> encoded(const std::string& where, const Write& write) {
  try {
    Imf::StdOSStream stream;
    write(stream);
    const std::string text = stream.str();
    return {text.begin(), text.end()};
  } catch (const std::exception& fault) {
    throw Error(ErrorKind::kIo, where, std::string("OpenEXR cannot encode it (") + fault.what() + ")");
  }
}

}  // namespace

void require_bounded_exr(std::span<const std::uint8_t> bytes, const std::string& where, std::int64_t most) {
  Headers(bytes, most, where).require_bounded();
}

void read_exr(const std::vector<std::uint8_t>& bytes, const std::string& where, std::int64_t most,
              const std::function<void(Imf::InputFile&)>& read) {
  require_bounded_exr(bytes, where, most);
  try {
    Imf::StdISStream stream;
    stream.str({bytes.begin(), bytes.end()});
    Imf::InputFile file(stream, 0);
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
  return encoded(where, [&](Imf::OStream& stream) {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(buffer);
    file.writePixels(rows_of(header));
  });
}

cv::Mat with_y_turned(const cv::Mat& motion) {
  cv::Mat turned = motion.clone();
  for (int y = 0; y < turned.rows; ++y)
    for (int x = 0; x < turned.cols; ++x) turned.at<cv::Vec2f>(y, x)[1] *= -1;
  return turned;
}

std::vector<std::uint8_t> encode_exr_parts(std::vector<Imf::Header> headers,
                                           std::span<const Imf::FrameBuffer> buffers,
                                           const std::string& where) {
  for (Imf::Header& header : headers) header.setType(Imf::SCANLINEIMAGE);
  return encoded(where, [&](Imf::OStream& stream) {
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), false, 0);
    for (std::size_t i = 0; i < headers.size(); ++i) {
      Imf::OutputPart part(file, static_cast<int>(i));
      part.setFrameBuffer(buffers[i]);
      part.writePixels(rows_of(headers[i]));
    }
  });
}

}  // namespace freshet::media
