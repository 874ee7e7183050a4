#include "media/picture/picture_file.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>

#include <unistd.h>

#include <opencv2/imgcodecs.hpp>

#include "freshet/error.h"
#include "media/frame/decoder.h"
#include "media/frame/file_format.h"
#include "platform/open_remedy.h"
#include "platform/standard_descriptors.h"
#include "platform/unfinished_files.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

using StdFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
using Bytes = std::vector<std::uint8_t>;

[[noreturn]] void fail_io(const fs::path& path, int code) {
  throw Error(ErrorKind::kIo, path.string(), std::string("cannot be written (") + std::strerror(code) + ")",
              code == ENOSPC || code == EFBIG || code == EDQUOT ? "Make room on the disk"
                                                                : "Check the folder and its permissions");
}

}  // namespace

Bytes read_bytes(const fs::path& path) {
  require_file(path);
  std::error_code fault;
  const std::uintmax_t size = fs::file_size(path, fault);
  if (fault || size > (std::uintmax_t{1} << 31))
    throw Error(ErrorKind::kInput, path.string(), fault ? fault.message() : "the file is above 2 GiB",
                "Name a picture");
  const StdFile file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (!file)
    throw Error(ErrorKind::kInput, path.string(), std::strerror(errno),
                open_remedy(errno, "Check its permissions"));
  Bytes bytes(size);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file.get()));
  if (bytes.empty())
    throw Error(ErrorKind::kInput, path.string(), "nothing can be read from it", "Check the disk");
  return bytes;
}

Bytes encode_picture(const fs::path& path, const cv::Mat& picture) {
  const std::string ending = path.extension().string();
  if (!looks_like_picture(path))
    throw Error(ErrorKind::kUsage, path.string(),
                "the ending \"" + ending + "\" is no picture format that is known",
                "Use .png, .jpg, .tif, .bmp or .webp");
  Bytes bytes;
  std::string fault = "OpenCV cannot encode it";
  try {
    if (!picture.empty() && cv::imencode(ending, picture, bytes) && !bytes.empty()) return bytes;
    if (picture.empty()) fault = "the picture is empty";
  } catch (const cv::Exception& thrown) {
    fault = thrown.err;
  }
  throw Error(ErrorKind::kUsage, path.string(),
              "a picture of " + std::to_string(picture.cols) + " x " + std::to_string(picture.rows) +
                  " with " + std::to_string(picture.channels()) + " channels cannot be written as " + ending +
                  " (" + fault + ")",
              "Use .png");
}

fs::path temporary_beside(const fs::path& path) {
  static std::atomic<unsigned> serial{0};
  std::string name = ".";  // appended to, because GCC 12 warns wrongly of "..." + std::to_string
  name += path.stem().string();
  name += ".part";
  name += std::to_string(::getpid());
  name += '-';
  name += std::to_string(serial++);
  name += path.extension().string();
  return path.parent_path() / name;
}

void require_folder_of(const fs::path& path) {
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code fault;
  if (!fs::is_directory(folder, fault))
    throw Error(ErrorKind::kIo, path.string(), "the folder " + folder.string() + " does not exist",
                "Make it first");
}

void move_into_place(const fs::path& temporary, const fs::path& path) {
  std::error_code fault;
  fs::rename(temporary, path, fault);
  if (!fault) return;
  std::error_code ignored;
  fs::remove(temporary, ignored);
  fail_io(path, fault.value());
}

void write_bytes(const fs::path& path, const Bytes& bytes) {
  require_folder_of(path);
  const fs::path temporary = temporary_beside(path);
  const UnfinishedFile unfinished(temporary);
  const StandardDescriptors standing_in;
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (!file) fail_io(path, errno);
  int code = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size() ? 0 : errno;
  if (std::fclose(file) != 0 && code == 0) code = errno;
  if (code != 0) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    fail_io(path, code);
  }
  move_into_place(temporary, path);
}

}  // namespace freshet::media
