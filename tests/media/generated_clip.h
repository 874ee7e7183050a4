// tests/media/generated_clip.h — clips made by the ffmpeg program, and its own account of their frames.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::media {

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

}  // namespace freshet::media
