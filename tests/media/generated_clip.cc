#include "tests/media/generated_clip.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>

#include <unistd.h>

#include <gtest/gtest.h>

#include "media/frame/frame_md5.h"
#include "media/video/video_reader.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::media {

namespace fs = std::filesystem;

bool have_ffmpeg() {
  static const bool have = std::system("ffmpeg -version > /dev/null 2>&1") == 0;
  return have;
}

void make_clip(const std::string& arguments, const fs::path& file) {
  const std::string command = "ffmpeg -nostdin -v error -y " + arguments + " '" + file.string() + "'";
  ASSERT_EQ(std::system(command.c_str()), 0) << command;
}

std::vector<std::string> ffmpeg_hashes(const fs::path& file, const std::string& before,
                                       const std::string& after) {
  const std::string command = "ffmpeg -nostdin -v quiet -noautorotate " + before + " -i '" + file.string() +
                              "' -map 0:v:0 -fps_mode passthrough " + after + " -f framemd5 -";
  std::vector<std::string> hashes;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  char line[512];
  while (pipe && std::fgets(line, sizeof line, pipe.get())) {
    const std::string text(line);
    if (text[0] != '#') hashes.push_back(text.substr(text.rfind(' ') + 1, 32));
  }
  return hashes;
}

std::vector<std::string> our_hashes(const fs::path& file, int threads) {
  std::vector<std::string> hashes;
  VideoReader reader(file, threads);
  while (const auto frame = reader.next()) hashes.push_back(frame_md5(*frame));
  return hashes;
}

std::vector<char> bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void put_bytes(const fs::path& file, const std::vector<char>& bytes) {
  std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace freshet::media
