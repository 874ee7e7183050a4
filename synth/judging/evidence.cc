#include "synth/judging/evidence.h"

#include <algorithm>
#include <cassert>

#include <opencv2/imgproc.hpp>

#include "platform/stopwatch.h"

namespace freshet::synth::judging {
namespace {

cv::Mat reduced(const cv::Mat& picture, cv::Size size) {
  if (picture.size() == size) return picture.clone();
  cv::Mat small;
  cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  return small;
}

cv::Mat luma_of(const cv::Mat& bgr) {
  cv::Mat luma;
  cv::cvtColor(bgr, luma, cv::COLOR_BGR2GRAY);
  return luma;
}

}  // namespace

Evidence::Evidence(const cv::Mat& picture, const cv::Mat& matte, double fps, int side)
    : picture_(picture.size()), fps_(fps) {
  assert(picture.type() == CV_8UC3 && matte.type() == CV_8U && matte.size() == picture.size());
  const double scale = std::min(1.0, static_cast<double>(side) / std::max(picture.cols, picture.rows));
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  still_ = reduced(picture, size);
  still_luma_ = luma_of(still_);
  matte_ = reduced(matte, size);
  fluid_ = matte_ > 127;
}

void Evidence::add(const cv::Mat& frame) {
  assert(frame.type() == CV_8UC3 && frame.size() == picture_);
  if (count() >= kJudgedFrames) return;
  const Stopwatch watch;
  frames_.push_back(reduced(frame, size()));
  luma_.push_back(luma_of(frames_.back()));
  seconds_ += watch.seconds();
}

}  // namespace freshet::synth::judging
