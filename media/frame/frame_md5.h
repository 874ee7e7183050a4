// media/frame/frame_md5.h — a frame's hash as FFmpeg's framemd5 muxer computes and prints it.
//
// Two decoders agree when these lines agree:
//   ffmpeg -noautorotate -i clip.mp4 -map 0:v:0 -fps_mode passthrough -f framemd5 -
#pragma once

#include <cstdint>
#include <string>

#include "media/frame/frame.h"

namespace freshet::media {

/// MD5 over the planes in order, rows packed (width * bytes_per_sample): 32 hex digits.
std::string frame_md5(const Frame& frame);

/// Bytes that frame_md5 hashes.
std::int64_t packed_size(const PixelLayout& layout);

/// The comment lines before the first frame, for stream 0, without the version of FFmpeg (as with -bitexact).
/// tb    one tick of the stamps below, in seconds: tb_num / tb_den.
std::string framemd5_header(const PixelLayout& layout, std::int64_t tb_num, std::int64_t tb_den);
/// "0, dts, pts, duration, size, hash" padded as FFmpeg pads it, without a line end; dts = pts.
std::string framemd5_line(const Frame& frame, std::int64_t pts, std::int64_t duration);

}  // namespace freshet::media
