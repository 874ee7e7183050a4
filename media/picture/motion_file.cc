#include "media/picture/motion_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <fmt/format.h>

#include "freshet/error.h"
#include "media/picture/exr_stream.h"
#include "media/picture/picture_file.h"
#include "platform/text.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

using Bytes = std::vector<std::uint8_t>;

static_assert(std::endian::native == std::endian::little,
              "the file's numbers are copied as they lie in memory");
constexpr std::array<char, 4> kTag{'P', 'I', 'E', 'H'};
constexpr int kMaxSide = 32768;
constexpr std::size_t kHeaderBytes = 12, kPixelBytes = 8;

bool is_exr(const fs::path& path) { return lower_ending(path) == ".exr"; }
bool is_flo(const fs::path& path) { return lower_ending(path) == ".flo"; }

bool in_range(std::int64_t width, std::int64_t height) {
  return width >= 1 && height >= 1 && width <= kMaxSide && height <= kMaxSide;
}

Bytes encode_flo(const cv::Mat& motion) {
  Bytes bytes(kHeaderBytes + kPixelBytes * motion.total());
  const std::int32_t size[2] = {motion.cols, motion.rows};
  std::memcpy(bytes.data(), kTag.data(), kTag.size());
  std::memcpy(bytes.data() + kTag.size(), size, sizeof size);
  const std::size_t row = kPixelBytes * static_cast<std::size_t>(motion.cols);
  for (int y = 0; y < motion.rows; ++y)
    std::memcpy(bytes.data() + kHeaderBytes + row * static_cast<std::size_t>(y), motion.ptr(y), row);
  return bytes;
}

cv::Mat decode_flo(const Bytes& bytes, const std::string& where) {
  const auto refuse = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, where, fault, "Give a Middlebury .flo file");
  };
  if (bytes.size() < kHeaderBytes || std::memcmp(bytes.data(), kTag.data(), kTag.size()) != 0)
    refuse("it does not begin with the tag PIEH");
  std::int32_t size[2] = {0, 0};
  std::memcpy(size, bytes.data() + kTag.size(), sizeof size);
  if (!in_range(size[0], size[1])) refuse(fmt::format("a size of {} x {} is out of range", size[0], size[1]));
  const std::size_t row = kPixelBytes * static_cast<std::size_t>(size[0]);
  const std::size_t expected = kHeaderBytes + row * static_cast<std::size_t>(size[1]);
  if (bytes.size() != expected)
    refuse(fmt::format("{} x {} pixels need {} bytes, the file has {}", size[0], size[1], expected,
                       bytes.size()));
  cv::Mat motion(size[1], size[0], CV_32FC2);
  for (int y = 0; y < motion.rows; ++y)
    std::memcpy(motion.ptr(y), bytes.data() + kHeaderBytes + row * static_cast<std::size_t>(y), row);
  return motion;
}

Bytes encode_motion(const cv::Mat& motion, const std::string& where) {
  const cv::Mat upwards = with_y_turned(motion);
  std::vector<half> x(motion.total()), y(motion.total());
  for (int row = 0; row < motion.rows; ++row)
    for (int column = 0; column < motion.cols; ++column) {
      const cv::Vec2f& at = upwards.at<cv::Vec2f>(row, column);
      const std::size_t i = static_cast<std::size_t>(row) * static_cast<std::size_t>(motion.cols) +
                            static_cast<std::size_t>(column);
      x[i] = at[0];
      y[i] = at[1];
    }
  Imf::Header header(motion.cols, motion.rows);
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert(kMotionX, Imf::Channel(Imf::HALF));
  header.channels().insert(kMotionY, Imf::Channel(Imf::HALF));
  Imf::FrameBuffer buffer;
  const std::size_t row_bytes = sizeof(half) * static_cast<std::size_t>(motion.cols);
  buffer.insert(kMotionX, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(x.data()), sizeof(half), row_bytes));
  buffer.insert(kMotionY, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(y.data()), sizeof(half), row_bytes));
  return encode_exr(header, buffer, where);
}

// The pair of channels that holds the motion, x first.
using ChannelPair = std::pair<std::string, std::string>;

std::optional<ChannelPair> motion_channels(const Imf::ChannelList& channels) {
  static constexpr std::array<std::pair<const char*, const char*>, 3> kPairs{
      {{"u", "v"}, {"x", "y"}, {"r", "g"}}};
  const auto last_part = [](const std::string& name) { return lower_case(name.substr(name.rfind('.') + 1)); };
  const auto layer = [](const std::string& name) {
    return name.substr(0, name.rfind('.') == std::string::npos ? 0 : name.rfind('.') + 1);
  };
  const auto find = [&](const std::string& of_layer, const std::string& part) -> std::optional<std::string> {
    for (auto at = channels.begin(); at != channels.end(); ++at)
      if (layer(at.name()) == of_layer && last_part(at.name()) == part) return at.name();
    return std::nullopt;
  };
  std::optional<ChannelPair> best;
  for (const auto& [first, second] : kPairs)
    for (auto at = channels.begin(); at != channels.end(); ++at) {
      const std::string of_layer = layer(at.name());
      if (last_part(at.name()) != first) continue;
      const std::optional<std::string> other = find(of_layer, second);
      if (!other || (*first == 'r' && find(of_layer, "b"))) continue;
      if (lower_case(of_layer) == "forward.") return ChannelPair{at.name(), *other};
      if (!best) best = ChannelPair{at.name(), *other};
    }
  return best;
}

std::string names_of(const Imf::ChannelList& channels) {
  std::string names;
  for (auto at = channels.begin(); at != channels.end(); ++at)
    names += (names.empty() ? "" : ", ") + std::string(at.name());
  return names;
}

cv::Mat read_pair(Imf::InputFile& file, const std::string& where) {
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  if (!in_range(width, height))
    throw Error(ErrorKind::kInput, where, fmt::format("a size of {} x {} is out of range", width, height));
  if (window != file.header().displayWindow())
    throw Error(ErrorKind::kInput, where, "its data window is not its display window",
                "Write the whole picture, not only the part that moves");
  const Imf::ChannelList& channels = file.header().channels();
  const std::optional<ChannelPair> pair = motion_channels(channels);
  if (!pair)
    throw Error(ErrorKind::kInput, where, "none of its channels are motion; it has " + names_of(channels),
                "Name them u and v, x and y, or R and G without B, px per frame");
  for (const std::string& name : {pair->first, pair->second}) {
    const Imf::Channel& channel = channels[name.c_str()];
    if (channel.type == Imf::UINT || channel.xSampling != 1 || channel.ySampling != 1)
      throw Error(ErrorKind::kInput, where, "channel " + name + " is no half or float for every pixel");
  }
  cv::Mat motion(static_cast<int>(height), static_cast<int>(width), CV_32FC2, cv::Scalar(0, 0));
  char* const origin = exr_origin(motion, file);
  Imf::FrameBuffer buffer;
  buffer.insert(pair->first, Imf::Slice(Imf::FLOAT, origin, sizeof(cv::Vec2f), motion.step[0]));
  buffer.insert(pair->second,
                Imf::Slice(Imf::FLOAT, origin + sizeof(float), sizeof(cv::Vec2f), motion.step[0]));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return motion;
}

cv::Mat decode_motion(const Bytes& bytes, const std::string& where) {
  cv::Mat motion;
  read_exr(bytes, where, std::int64_t{kMaxSide} * kMaxSide,
           [&](Imf::InputFile& file) { motion = read_pair(file, where); });
  return with_y_turned(motion);
}

}  // namespace

bool looks_like_motion(const fs::path& path) { return is_flo(path) || is_exr(path); }

void write_motion(const fs::path& path, const cv::Mat& motion) {
  if (motion.type() != CV_32FC2 || !in_range(motion.cols, motion.rows))
    throw Error(ErrorKind::kUsage, path.string(), "a motion field is CV_32FC2, 1 to 32768 pixels per side");
  if (!looks_like_motion(path))
    throw Error(ErrorKind::kUsage, path.string(), "the ending names no format of motion", "Use .flo or .exr");
  write_bytes(path, is_exr(path) ? encode_motion(motion, path.string()) : encode_flo(motion));
}

cv::Mat read_motion(const fs::path& path) {
  const Bytes bytes = read_bytes(path);
  return is_exr(path) ? decode_motion(bytes, path.string()) : decode_flo(bytes, path.string());
}

}  // namespace freshet::media
