#include "synth/animate/forms/handed_frame.h"

namespace freshet::synth::animate {

cv::Mat handed_on(const cv::Mat& frame, const cv::Mat& picture, const cv::Mat& matte, FrameForm form) {
  if (form == FrameForm::kWhole) {
    cv::Mat whole;
    frame.convertTo(whole, CV_8U, 255);
    return whole;
  }
  cv::Mat fluid(frame.size(), CV_32FC4);
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x) {
      const float share = matte.at<float>(y, x);
      const cv::Vec3f over = frame.at<cv::Vec3f>(y, x) - (1 - share) * picture.at<cv::Vec3f>(y, x);
      fluid.at<cv::Vec4f>(y, x) = {over[0], over[1], over[2], share};
    }
  return fluid;
}

}  // namespace freshet::synth::animate
