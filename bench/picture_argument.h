// bench/picture_argument.h — PICTURE[:MATTE] of a bench's command line, read.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "media/picture.h"

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

}  // namespace freshet::bench
