#include "synth/outline/background.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "freshet/error.h"
#include "synth/outline/moving_outline.h"
#include "tests/harness/fault.h"

namespace freshet::synth::outline {
namespace {

/// A sky that grows lighter downwards, and a flame before it.
struct Scene {
  cv::Mat sky, picture, matte;
};

Scene scene(cv::Size size = {160, 120}) {
  Scene out;
  out.sky.create(size, CV_8UC3);
  for (int y = 0; y < size.height; ++y) out.sky.row(y).setTo(cv::Scalar(60 + y, 50 + y / 2, 40 + y / 3));
  out.matte = cv::Mat::zeros(size, CV_8U);
  cv::ellipse(out.matte, {size.width / 2, size.height / 2}, {size.width / 10, size.height / 5}, 0, 0, 360,
              255, -1);
  out.picture = out.sky.clone();
  out.picture.setTo(cv::Scalar(40, 160, 255), out.matte);
  return out;
}

TEST(Background, EveryMethodFindsASmoothSkyBehindAFlame) {
  const Scene s = scene();
  for (const char* name : {"telea", "navier-stokes", "shift-map", "fsr", "outward"}) {
    InpaintOptions options;
    options.method = parse_inpaint_method(name);
    const cv::Mat found = inpaint_background(s.picture, s.matte, options);
    EXPECT_LT(cv::norm(found, s.sky, cv::NORM_L1) / (3.0 * cv::countNonZero(s.matte)), 25) << name;
    cv::Mat around;
    cv::dilate(s.matte, around, cv::getStructuringElement(cv::MORPH_ELLIPSE, {9, 9}));
    EXPECT_EQ(cv::norm(found, s.picture, cv::NORM_INF, ~around), 0) << name << " changed the rest";
  }
}

TEST(Background, IsFoundOnAReducedCopyOfALargePicture) {
  const Scene s = scene({640, 480});
  InpaintOptions options;
  options.max_side_px = 160;
  const cv::Mat found = inpaint_background(s.picture, s.matte, options);
  EXPECT_EQ(found.size(), s.picture.size());
  EXPECT_LT(cv::norm(found, s.sky, cv::NORM_L1) / (3.0 * cv::countNonZero(s.matte)), 12);
}

TEST(Background, AMatteThatCoversEverythingLeavesNoneToBeSeen) {
  const Scene s = scene();
  const std::string fault = fault_of(ErrorKind::kInput, [&] {
    inpaint_background(s.picture, cv::Mat(s.picture.size(), CV_8U, cv::Scalar(255)));
  });
  EXPECT_NE(fault.find("--background"), std::string::npos) << fault;
}

TEST(Background, AnEmptyMatteHidesNothing) {
  const Scene s = scene();
  const cv::Mat found = inpaint_background(s.picture, cv::Mat::zeros(s.picture.size(), CV_8U));
  EXPECT_EQ(cv::norm(found, s.picture, cv::NORM_INF), 0);
}

TEST(Background, AGivenOneLiesInsideTheMatteOnly) {
  const Scene s = scene();
  MovingOutlineOptions options;
  options.background = cv::Mat(s.picture.size(), CV_8UC3, cv::Scalar(10, 20, 30));
  cv::Mat behind = behind_fluid(s.picture, s.matte, options), picture;
  s.picture.convertTo(picture, CV_32F, 1.0 / 255);
  EXPECT_LT(cv::norm(behind, picture, cv::NORM_INF, ~s.matte), 1e-6);
  EXPECT_LT(
      cv::norm(behind, cv::Mat(behind.size(), CV_32FC3, cv::Scalar(10, 20, 30) / 255), cv::NORM_INF, s.matte),
      1e-6);
}

TEST(Background, OneOfAnotherSizeIsRefused) {
  const Scene s = scene();
  MovingOutlineOptions options;
  options.background = cv::Mat::zeros(90, 100, CV_8UC3);
  const std::string fault = fault_of(ErrorKind::kInput, [&] { behind_fluid(s.picture, s.matte, options); });
  EXPECT_NE(fault.find("100 x 90"), std::string::npos) << fault;
}

}  // namespace
}  // namespace freshet::synth::outline
