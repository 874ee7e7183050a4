// tests/media/generated_clip.h — clips made by the ffmpeg program, and its own account of their frames.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "freshet/error.h"

namespace freshet::media {

/// A folder of this test alone, removed at the end.
class Scratch {
 public:
  Scratch();
  ~Scratch();
  std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// False, loudly, where the ffmpeg program is missing.
bool have_ffmpeg();
/// ffmpeg -y ARGUMENTS FILE. Fails the test when that fails.
void make_clip(const std::string& arguments, const std::filesystem::path& file);
/// Hashes of the frames of a file as ffmpeg's framemd5 gives them; before and after: further options.
std::vector<std::string> ffmpeg_hashes(const std::filesystem::path& file, const std::string& before = "",
                                       const std::string& after = "");
/// Ours.
std::vector<std::string> our_hashes(const std::filesystem::path& file, int threads = 0);

std::vector<char> bytes_of(const std::filesystem::path& file);
void put_bytes(const std::filesystem::path& file, const std::vector<char>& bytes);

/// What an action throws, as text; fails the test when it throws nothing or another kind.
std::string fault_of(ErrorKind kind, const std::function<void()>& action);

}  // namespace freshet::media
