#include "synth/outline/background.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>
#include <opencv2/xphoto/inpainting.hpp>

#include "freshet/error.h"
#include "synth/sampling/pull_push.h"

namespace freshet::synth::outline {
namespace {

constexpr double kMinBackground = 0.01;  // fraction of the picture from which the rest can be guessed

cv::Mat fill(const cv::Mat& picture, const cv::Mat& hole, const InpaintOptions& options) {
  cv::Mat out;
  switch (options.method) {
    case InpaintMethod::kTelea:
      cv::inpaint(picture, hole, out, options.radius_px, cv::INPAINT_TELEA);
      break;
    case InpaintMethod::kNavierStokes:
      cv::inpaint(picture, hole, out, options.radius_px, cv::INPAINT_NS);
      break;
    case InpaintMethod::kShiftMap: {
      // It wants intensity apart from colour.
      cv::Mat lab;
      cv::cvtColor(picture, lab, cv::COLOR_BGR2Lab);
      lab.setTo(0, hole);
      cv::xphoto::inpaint(lab, ~hole, out, cv::xphoto::INPAINT_SHIFTMAP);
      cv::cvtColor(out, out, cv::COLOR_Lab2BGR);
      break;
    }
    case InpaintMethod::kFsrFast:
      cv::xphoto::inpaint(picture, ~hole, out, cv::xphoto::INPAINT_FSR_FAST);
      break;
    case InpaintMethod::kPullPush: {
      cv::Mat values, trust;
      picture.convertTo(values, CV_32F);
      cv::Mat(~hole).convertTo(trust, CV_32F, 1.0 / 255);
      sampling::pull_push(values, trust).convertTo(out, CV_8U);
      break;
    }
  }
  return out;
}

}  // namespace

InpaintMethod parse_inpaint_method(const std::string& name) {
  static const std::map<std::string, InpaintMethod> kMethods{{"telea", InpaintMethod::kTelea},
                                                             {"navier-stokes", InpaintMethod::kNavierStokes},
                                                             {"shift-map", InpaintMethod::kShiftMap},
                                                             {"fsr", InpaintMethod::kFsrFast},
                                                             {"outward", InpaintMethod::kPullPush}};
  const auto found = kMethods.find(name);
  if (found == kMethods.end())
    throw Error(ErrorKind::kUsage, "inpainting by " + name, "no such method",
                "telea, navier-stokes, shift-map, fsr or outward");
  return found->second;
}

cv::Mat inpaint_background(const cv::Mat& picture, const cv::Mat& matte, const InpaintOptions& options) {
  cv::Mat hole = matte > 0;
  if (options.margin_px > 0) {
    const int side = 2 * options.margin_px + 1;
    cv::dilate(hole, hole, cv::getStructuringElement(cv::MORPH_ELLIPSE, {side, side}));
  }
  const auto hidden = static_cast<double>(cv::countNonZero(hole));
  if (hidden == 0) return picture.clone();
  if (hidden > (1 - kMinBackground) * static_cast<double>(hole.total()))
    throw Error(ErrorKind::kInput, "matte", "it covers the picture: no background is to be seen",
                "Give the picture behind the fluid with --background, or a matte of the fluid alone");

  cv::Mat filled;
  const double scale = static_cast<double>(options.max_side_px) / std::max(picture.cols, picture.rows);
  if (scale >= 1) {
    filled = fill(picture, hole, options);
  } else {
    // What is guessed has little detail, so it may come from a reduced copy. Only background is reduced with
    // background: the hole is filled before, or the fluid's light would bleed into its rim.
    const cv::Size size(std::max(1, static_cast<int>(std::lround(picture.cols * scale))),
                        std::max(1, static_cast<int>(std::lround(picture.rows * scale))));
    cv::Mat values, trust, small, small_hole;
    picture.convertTo(values, CV_32F);
    cv::Mat(~hole).convertTo(trust, CV_32F, 1.0 / 255);
    sampling::pull_push(values, trust).convertTo(values, CV_8U);
    cv::resize(values, small, size, 0, 0, cv::INTER_AREA);
    cv::resize(hole, small_hole, size, 0, 0, cv::INTER_AREA);
    filled = fill(small, small_hole > 0, options);
    cv::resize(filled, filled, picture.size(), 0, 0, cv::INTER_CUBIC);
  }
  cv::Mat out = picture.clone();
  filled.copyTo(out, hole);
  return out;
}

}  // namespace freshet::synth::outline
