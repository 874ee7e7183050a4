// media/picture/passes.h — the fluid, what lies below it, and the two together, as files hold them.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::media {

/// What of an animation is written.
enum class Layer {
  kWhole,  // the picture with the fluid in it
  kFluid,  // the fluid alone, with alpha: over the picture it gives the whole
  kLight,  // what the fluid adds to what lies behind it, on black: for add (linear dodge) in a compositor
};

enum class AlphaForm { kStraight, kPremultiplied };

/// The values of a file.
enum class Samples {
  k8,      // sRGB code, CV_8U
  k16,     // sRGB code, CV_16U
  kLight,  // linear light, CV_32F: EXR. Layers lie over each other in linear light there
};

/// Turns a fluid, frame by frame, into what is written.
class Layers {
 public:
  /// below      CV_32FC3, sRGB code, 1 is white: what the fluid lies over; of a moving outline the background.
  /// original   CV_8UC3, CV_16UC3 (sRGB code) or CV_32FC3 (linear light): the picture as it was read. Where matte
  ///            and fluid are 0 a whole frame has its values, to the last bit where the samples can hold them.
  /// matte      CV_8U.
  Layers(const cv::Mat& below, const cv::Mat& original, const cv::Mat& matte, Layer layer, AlphaForm alpha,
         Samples samples);

  /// fluid     CV_32FC4: sRGB code times alpha, and alpha.
  /// Returns   3 channels (whole, light) or 4 (fluid) of the samples' type, BGR and alpha.
  cv::Mat frame(const cv::Mat& fluid) const;
  /// The whole, CV_8UC3, for a person to look at.
  cv::Mat shown(const cv::Mat& fluid) const;

 private:
  void whole(const cv::Vec4f& fluid, const cv::Point& at, cv::Vec3f& out) const;

  cv::Mat below_, below_light_, original_, matte_;
  Layer layer_;
  AlphaForm alpha_;
  Samples samples_;
};

}  // namespace freshet::media
