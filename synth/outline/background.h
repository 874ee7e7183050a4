// synth/outline/background.h — what lies behind the fluid, guessed from the picture around it.
#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace freshet::synth::outline {

enum class InpaintMethod {
  kTelea,         // cv::inpaint: fast marching (Telea 2004)
  kNavierStokes,  // cv::inpaint: isophotes continued (Bertalmio et al. 2001)
  kShiftMap,      // cv::xphoto: pieces of the picture shifted in (He and Sun 2012)
  kFsrFast,       // cv::xphoto: frequency selective reconstruction (Genser et al. 2018)
  kPullPush,      // by pull_push: smooth, no structure
};
InpaintMethod parse_inpaint_method(const std::string& name);  // "telea", ...; Error{kUsage}

struct InpaintOptions {
  InpaintMethod method = InpaintMethod::kNavierStokes;
  int radius_px = 5;      // of the neighbourhood that Telea and Navier-Stokes look at
  int margin_px = 2;      // the hole is the matte and this much around it: its rim still holds fluid's light
  int max_side_px = 640;  // larger pictures are filled in on a reduced copy of this longer side
};

/// The picture with the region of the matte filled in from around it; everywhere else the picture itself.
/// picture  CV_8UC3.
/// matte    CV_8U, same size: a pixel above 0 is not background.
/// Throws   Error{kInput} when the matte leaves no background to be seen.
/// Cost     CPU seconds for 640 px, a blob of 16 % of the height: Navier-Stokes .06, Telea .18.
cv::Mat inpaint_background(const cv::Mat& picture, const cv::Mat& matte, const InpaintOptions& options = {});

}  // namespace freshet::synth::outline
