// tests/synth/matte/made_picture.h — pictures with a known alpha, and files in a folder of one test.
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

#include "freshet/error.h"
#include "synth/matte/marks.h"

namespace freshet::synth::matte {

/// A bright textured disc, its edge `softness` px wide, over a darker ground of another hue and texture.
struct MadePicture {
  cv::Mat picture;  // CV_8UC3
  cv::Mat alpha;    // CV_8U
  Marks marks;      // a dot of fluid in the disc, a frame of background along the picture's border
};
MadePicture made_picture(cv::Size size = {160, 120}, double softness = 6);

/// Sum of absolute differences, alpha 0..1, as a fraction of the truth's own area.
double sad_fraction(const cv::Mat& alpha, const cv::Mat& truth);

/// A folder that is removed with the test.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  std::filesystem::path write(const std::string& name, const std::string& text) const;
  std::filesystem::path write(const std::string& name, const cv::Mat& picture) const;

 private:
  std::filesystem::path path_;
};

/// What the Error says that this throws; empty when it throws none.
template <typename Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace freshet::synth::matte
