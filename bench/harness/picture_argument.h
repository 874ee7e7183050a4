// bench/harness/picture_argument.h — PICTURE[:MATTE] of a bench's command line, read.
#pragma once

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>

#include "freshet/error.h"
#include "media/picture/picture.h"

namespace freshet::bench {

struct PictureArgument {
  std::string name;  // of the picture's file, without its ending
  cv::Mat picture;   // CV_8UC3
  cv::Mat matte;     // CV_8U; 255 everywhere when none is given
};

inline PictureArgument read_picture_argument(const std::string& argument) {
  const std::size_t colon = argument.rfind(':');
  const std::filesystem::path path = argument.substr(0, colon);
  PictureArgument read{path.stem().string(), media::read_picture(path).bgr, {}};
  if (colon == std::string::npos) {
    read.matte = cv::Mat(read.picture.size(), CV_8U, cv::Scalar(255));
  } else {
    read.matte = media::read_matte(argument.substr(colon + 1), read.picture.size()).alpha;
  }
  return read;
}

/// WIDTHxHEIGHT, px; Error{kUsage} for another text.
inline cv::Size parse_size(const std::string& text) {
  cv::Size size;
  char between = 0, more = 0;
  std::istringstream stream(text);
  if (!(stream >> size.width >> between >> size.height) || between != 'x' || size.empty() || stream >> more)
    throw Error(ErrorKind::kUsage, "size \"" + text + "\"", "not a width and a height", "Write 640x480");
  return size;
}

/// The middle of a picture, of the shape of `size`, brought to that size.
inline PictureArgument brought_to(PictureArgument read, cv::Size size) {
  const cv::Size whole = read.picture.size();
  const double scale = std::min(1.0 * whole.width / size.width, 1.0 * whole.height / size.height);
  const cv::Size part(static_cast<int>(size.width * scale), static_cast<int>(size.height * scale));
  const cv::Rect middle({(whole.width - part.width) / 2, (whole.height - part.height) / 2}, part);
  const int method = scale > 1 ? cv::INTER_AREA : cv::INTER_CUBIC;
  cv::resize(read.picture(middle).clone(), read.picture, size, 0, 0, method);
  cv::resize(read.matte(middle).clone(), read.matte, size, 0, 0, method);
  return read;
}

}  // namespace freshet::bench
