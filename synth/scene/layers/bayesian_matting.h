// synth/scene/layers/bayesian_matting.h — alpha, foreground and background colours of a picture from a trimap.
#pragma once

#include <opencv2/core.hpp>

#include "synth/scene/layers/colour_clusters.h"

namespace freshet::synth::scene {

struct MattingOptions {
  ClusterOptions clusters{};
  float camera_sigma = 0.008f;  // of a pixel's colour, 0..1
  double falloff_px = 8;        // of a neighbour's weight (a Gaussian's sigma)
  int min_samples = 150;        // of either side: the window grows until it has so many
  int max_window_px = 96;       // half its side
  float smoothing = 100;        // of uncertain alpha towards like neighbours; 0: none, as in the paper
  float like_sigma = 0.05f;     // of neighbours' colours, 0..1, by which they are like
};

struct Matting {
  cv::Mat alpha;  // CV_32F, 0..1
  cv::Mat foreground,
      background;  // CV_32FC3; the picture where alpha is 1 (0) in the trimap, 0 on the other side
};

/// What of each unsure pixel is foreground, and the two colours that it is mixed of.
///
/// picture  CV_32FC3, 0..1 (more is taken as it is).
/// trimap   CV_8U of its size: 255 foreground, 0 background, all else unsure.
/// Cost     some 20 us per unsure pixel and thread. The same for any number of threads.
/// Source   Chuang, Curless, Salesin, Szeliski 2001, A Bayesian approach to digital matting. Each pixel's colour is
///          explained by a pair of Gaussians, one of the foreground's colours nearby and one of the background's,
///          known or found before (weights as theirs), and of all pairs the likeliest is taken (unmix.h, with what
///          differs there). Pixels are taken contour by contour, as theirs, but those of one contour do not see each
///          other: they can be found at once, and in any order. Last, alpha that the posterior leaves open goes over
///          to that of neighbours of like colour (smoothing; theirs has none).
Matting bayesian_matting(const cv::Mat& picture, const cv::Mat& trimap, const MattingOptions& options = {});

/// The two colours where alpha is known, in the same way.
/// alpha   CV_32F, 0..1: it comes back as it is.
Matting estimate_colours(const cv::Mat& picture, const cv::Mat& alpha, const MattingOptions& options = {});

}  // namespace freshet::synth::scene
