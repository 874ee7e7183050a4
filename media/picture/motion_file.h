// media/picture/motion_file.h — motion fields in files: Middlebury .flo, and OpenEXR as compositors have it.
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace freshet::media {

/// The channels of an EXR's motion.
inline constexpr const char *kMotionX = "forward.u", *kMotionY = "forward.v";

/// By the name's ending, .flo or .exr, in any case.
bool looks_like_motion(const std::filesystem::path& path);

/// Writes one field.
/// motion  CV_32FC2, 1 to 32768 px per side, px per frame, x right, y down, whatever the file's own axes.
/// .flo    "PIEH", width and height as 32-bit integers, then u, v row by row as 32-bit floats, y down; all
///         little-endian. Source: Baker et al. 2011, "A database and evaluation methodology for optical
///         flow".
/// .exr    half-float channels forward.u and forward.v, ZIP, y up: what Nuke and its like show as motion. A
///         half has 11 bits: 1/128 px at speeds from 8 to 16 px per frame. Above 65504 it is infinite.
/// Throws  Error{kUsage} for another type, an empty field or another ending; Error{kIo} when the folder is
///         missing or the disk full: nothing is left behind under `path` then, the bytes go to a neighbour
///         that is renamed when whole.
void write_motion(const std::filesystem::path& path, const cv::Mat& motion);

/// Reads one field, as write_motion takes it. Of an EXR the two channels of half or float named u and v
/// (those of `forward`, where there are several pairs), x and y, or, in a file without B, R and G; y up.
/// Throws Error{kInput}: missing, neither format, damaged, a size outside 1..32768, more or fewer bytes than
/// the size asks for, no such channels. Lengths are checked before anything is allocated. Values are returned
/// as they stand, finite or not (.flo marks unknown motion by values above 1e9).
cv::Mat read_motion(const std::filesystem::path& path);

}  // namespace freshet::media
