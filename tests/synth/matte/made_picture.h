// tests/synth/matte/made_picture.h — pictures with a known alpha, and files in a folder of one test.
#pragma once

#include <filesystem>
#include <string>

#include <opencv2/core.hpp>

#include "freshet/error.h"
#include "synth/matte/marks.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

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

/// Writes a picture into a test's folder.
std::filesystem::path written(const ScratchFolder& folder, const std::string& name, const cv::Mat& picture);

}  // namespace freshet::synth::matte
