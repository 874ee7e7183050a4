#include "vision/look/fluid_look.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace freshet::vision {
namespace {

constexpr double kSide = 256;  // px

/// The picture's planes, CV_32F, and where the fluid is.
struct Planes {
  cv::Mat luma, blue, red, chroma, saturation, purity;  // purity: largest less smallest channel
  cv::Mat red_channel, bluer;                           // bluer: blue less red
  cv::Mat inside;                                       // CV_8U, 255 somewhere
};

Planes reduced(const cv::Mat& picture, const cv::Mat& matte) {
  const double scale = kSide / std::max(picture.cols, picture.rows);
  const cv::Size size(std::max(1, cvRound(picture.cols * scale)), std::max(1, cvRound(picture.rows * scale)));
  cv::Mat small, alpha;
  cv::resize(picture, small, size, 0, 0, cv::INTER_AREA);
  cv::resize(matte, alpha, size, 0, 0, cv::INTER_AREA);
  Planes planes;
  planes.inside = alpha > 127;
  if (cv::countNonZero(planes.inside) == 0) planes.inside = alpha > 0;  // a thread of fluid
  if (cv::countNonZero(planes.inside) == 0) planes.inside.setTo(255);
  // A matte of thin smoke is frayed: what lies in its gaps is fluid too.
  cv::morphologyEx(planes.inside, planes.inside, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_ELLIPSE, {9, 9}));

  small.convertTo(small, CV_32F, 1 / 255.);
  std::array<cv::Mat, 3> bgr;
  cv::split(small, bgr.data());
  planes.luma = .114 * bgr[0] + .587 * bgr[1] + .299 * bgr[2];
  planes.blue = bgr[0] - planes.luma;
  planes.red = bgr[2] - planes.luma;
  cv::magnitude(planes.blue, planes.red, planes.chroma);
  const cv::Mat largest = cv::max(cv::max(bgr[0], bgr[1]), bgr[2]),
                smallest = cv::min(cv::min(bgr[0], bgr[1]), bgr[2]);
  planes.purity = largest - smallest;
  cv::divide(planes.purity, largest + .05, planes.saturation);
  planes.red_channel = bgr[2];
  planes.bluer = bgr[0] - bgr[2];
  return planes;
}

double mean(const cv::Mat& plane, const cv::Mat& where) { return cv::mean(plane, where)[0]; }
double share(const cv::Mat& mask, const cv::Mat& where) { return mean(mask, where) / 255; }
double spread(const cv::Mat& plane, const cv::Mat& where) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(plane, mean, deviation, where);
  return deviation[0];
}
double covariance(const cv::Mat& a, const cv::Mat& b, const cv::Mat& where) {
  return mean(a.mul(b), where) - mean(a, where) * mean(b, where);
}

cv::Mat blurred(const cv::Mat& plane, double sigma) {
  cv::Mat out;
  cv::GaussianBlur(plane, out, {}, sigma);
  return out;
}
double log_contrast(const cv::Mat& band, const cv::Mat& where) {
  return std::log(std::sqrt(mean(band.mul(band), where)) + .002);
}

/// Of the structure tensor, weighed by its energy; the matte's rim is left out, as it may be another thing's edge.
double coherence(const cv::Mat& luma, const cv::Mat& inside) {
  const cv::Mat smooth = blurred(luma, 3);
  cv::Mat across, down, core;
  cv::Sobel(smooth, across, CV_32F, 1, 0, 3, 1 / 8.);
  cv::Sobel(smooth, down, CV_32F, 0, 1, 3, 1 / 8.);
  cv::erode(inside, core, cv::Mat::ones(5, 5, CV_8U));
  if (cv::countNonZero(core) < 50) core = inside;
  const cv::Mat xx = blurred(across.mul(across), 9), yy = blurred(down.mul(down), 9),
                xy = blurred(across.mul(down), 9);
  cv::Mat along;
  cv::magnitude(xx - yy, 2 * xy, along);
  const double pixels = cv::countNonZero(core);
  return pixels * mean(along, core) / (pixels * mean(xx + yy, core) + 1e-6);
}

cv::Mat ring_around(const cv::Mat& inside) {
  cv::Mat wide;
  cv::dilate(inside, wide, cv::getStructuringElement(cv::MORPH_ELLIPSE, {21, 21}));
  return wide & ~inside;
}

}  // namespace

FluidLook fluid_look(const cv::Mat& picture, const cv::Mat& matte) {
  assert(picture.type() == CV_8UC3 && matte.type() == CV_8U && picture.size() == matte.size());
  const Planes p = reduced(picture, matte);
  const cv::Mat& inside = p.inside;
  FluidLook look{};
  std::size_t next = 0;
  const auto put = [&](double figure) { look.at(next++) = static_cast<float>(figure); };

  put(mean(p.luma, inside));
  put(mean(p.red, inside));
  put(spread(p.red, inside));
  put(share(p.luma < .1, inside));
  put(share(p.luma > .85, inside));
  put(share((p.red > .15) & (p.red_channel > .5), inside));
  put(spread(p.chroma, inside));
  put(spread(p.saturation, inside));
  put(share(p.bluer > .08, inside));
  put(share(p.purity < .08, inside));

  const double fine = log_contrast(p.luma - blurred(p.luma, 1), inside),
               coarse = log_contrast(blurred(p.luma, 4) - blurred(p.luma, 8), inside);
  put(fine);
  put(coarse - fine);
  put(fine - std::log(spread(p.luma, inside) + .01));
  put(coherence(p.luma, inside));

  const cv::Moments m = cv::moments(inside, true);
  put(m.m01 / m.m00 / inside.rows - .5);
  put(std::log((std::sqrt(m.mu20 / m.m00) + 1) / (std::sqrt(m.mu02 / m.m00) + 1)));
  const cv::Mat ring = ring_around(inside);
  const bool surrounded = cv::countNonZero(ring) > 20;
  for (const cv::Mat& plane : {p.luma, p.blue}) put(surrounded ? mean(plane, inside) - mean(plane, ring) : 0);

  const double variance = covariance(p.luma, p.luma, inside) + 1e-4;
  for (const cv::Mat& plane : {p.red, p.blue, p.saturation})
    put(covariance(p.luma, plane, inside) / variance);
  assert(next == look.size());
  return look;
}

}  // namespace freshet::vision
