// media/video/frame_stamps.h — when the frames of a video are to be shown, read without decoding one.
#pragma once

#include <filesystem>
#include <vector>

namespace freshet::media {

/// Seconds, ascending, each once, the first 0: the stamps of the first video stream's packets. A header's rate is a
/// claim, and of a variable one a guess from its first frames. Empty for picture sequences, for streams without stamps,
/// and for interlaced ones, a packet of which may be half a frame; of a file that is cut short, those that are there.
/// Throws Error{kInput} as VideoReader, for what is no video.
std::vector<double> frame_stamps(const std::filesystem::path& video);

}  // namespace freshet::media
