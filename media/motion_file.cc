// media/motion_file.cc
#include "media/motion_file.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "freshet_error.h"

namespace freshet::media {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the file's numbers are copied as they lie in memory");
constexpr std::array<char, 4> kTag{'P', 'I', 'E', 'H'};
constexpr std::int32_t kMaxSide = 32768;
constexpr std::uintmax_t kHeaderBytes = 12, kPixelBytes = 8;

}  // namespace

void write_flo(const std::filesystem::path& path, const cv::Mat& motion) {
  if (motion.type() != CV_32FC2 || motion.empty() || motion.cols > kMaxSide || motion.rows > kMaxSide) {
    throw Error(ErrorKind::kUsage, path.string(), "a motion field is CV_32FC2, 1 to 32768 pixels a side");
  }
  const std::filesystem::path draft = path.string() + ".part";
  std::ofstream file(draft, std::ios::binary | std::ios::trunc);
  const std::int32_t size[2] = {motion.cols, motion.rows};
  file.write(kTag.data(), kTag.size());
  file.write(reinterpret_cast<const char*>(size), sizeof size);
  for (int y = 0; y < motion.rows; ++y) {
    file.write(reinterpret_cast<const char*>(motion.ptr(y)),
               static_cast<std::streamsize>(kPixelBytes) * motion.cols);
  }
  file.close();
  std::error_code failed;
  if (file.good()) std::filesystem::rename(draft, path, failed);
  if (!file.good() || failed) {
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    throw Error(ErrorKind::kIo, path.string(), "the motion field could not be written",
                "Check that the folder exists and that the disk has room");
  }
}

cv::Mat read_flo(const std::filesystem::path& path) {
  const auto refuse = [&](const std::string& fault) {
    throw Error(ErrorKind::kInput, path.string(), fault, "Give a Middlebury .flo file");
  };
  std::error_code failed;
  const std::uintmax_t bytes = std::filesystem::file_size(path, failed);
  std::ifstream file(path, std::ios::binary);
  if (failed || !file) refuse("the file cannot be read");
  std::array<char, 4> tag{};
  std::int32_t size[2] = {0, 0};
  file.read(tag.data(), tag.size());
  file.read(reinterpret_cast<char*>(size), sizeof size);
  if (!file || tag != kTag) refuse("it does not begin with the tag PIEH");
  if (size[0] < 1 || size[1] < 1 || size[0] > kMaxSide || size[1] > kMaxSide) {
    refuse(fmt::format("a size of {} x {} is out of range", size[0], size[1]));
  }
  const std::uintmax_t expected = kHeaderBytes + kPixelBytes * static_cast<std::uintmax_t>(size[0]) *
                                                     static_cast<std::uintmax_t>(size[1]);
  if (bytes != expected) {
    refuse(fmt::format("{} x {} pixels need {} bytes, the file has {}", size[0], size[1], expected, bytes));
  }
  cv::Mat motion(size[1], size[0], CV_32FC2);
  for (int y = 0; y < motion.rows; ++y) {
    file.read(reinterpret_cast<char*>(motion.ptr(y)),
              static_cast<std::streamsize>(kPixelBytes) * motion.cols);
  }
  if (!file) refuse("the file ended early");
  return motion;
}

}  // namespace freshet::media
