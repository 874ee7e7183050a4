// media/motion_file.h — motion fields in the Middlebury .flo format.
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace freshet::media {

/// motion  CV_32FC2, px a frame, x right, y down.
/// File    "PIEH", width and height as 32-bit integers, then u, v row by row as 32-bit floats; all
/// little-endian. Throws  Error{kUsage} for another type or an empty field; Error{kIo} when the folder is
/// missing or the disk full:
///         nothing is left behind under `path` then, the bytes go to a neighbour that is renamed when whole.
/// Source  Baker et al. 2011, "A database and evaluation methodology for optical flow".
void write_flo(const std::filesystem::path& path, const cv::Mat& motion);

/// Throws Error{kInput}: missing, wrong tag, size outside 1..32768, more or fewer bytes than the size asks
/// for. The length is checked before anything is allocated. Values are returned as they stand, finite or not
/// (the format marks unknown motion by values above 1e9).
cv::Mat read_flo(const std::filesystem::path& path);

}  // namespace freshet::media
