// hints/stroke_field.h — a few strokes made a direction, and a speed, for every pixel.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "freshet/motion.h"
#include "hints/strokes.h"

namespace freshet::hints {

/// Maps of the picture's size, as a MotionGuide takes them.
struct StrokeField {
  /// CV_32FC2, unit vectors, x right, y down; (0, 0) in the very middle of a vortex. Where strokes oppose each other it
  /// turns about within a few px: the animation lets the flow stand there.
  cv::Mat direction;
  /// CV_32F, px/s; empty when no stroke has a speed.
  cv::Mat speed;
  /// For a person: the first place where strokes run against each other (by more than 135 degrees within 12 px);
  /// empty: none.
  std::string clash;
};

/// How a stroke's weight falls with distance. The default was decided by eye (docs/measurements/motion.md).
enum class RadialKernel {
  kMultiquadric,  // -sqrt(r^2 + c^2): between strokes blends evenly, beyond them goes on as the nearest
  kThinPlate,     // r^2 log r, with a plane: bends least, and turns on without end beyond the strokes
  kGaussian,      // a stroke means nothing beyond its reach
};

struct StrokeFieldOptions {
  RadialKernel kernel = RadialKernel::kMultiquadric;
  double smoothing = 1e-3;  // ridge: 0 goes through every stroke exactly, more evens out a shaking hand
  /// Between strokes speeds are those of a plane that ends here (vision::seen_speed); none: of the picture.
  std::optional<Horizon> horizon{};
};

/// Interpolates cosine and sine of the strokes' directions, and the logarithm of their speeds, over the picture.
/// Strokes are sampled every few pixels inside the picture and a quarter of its size around it, at most 600 samples.
/// Speeds, on the plane where there is one, stay between the minimum and the maximum given. Those strokes that have a
/// speed decide it everywhere.
///
/// where    names the strokes' file in errors.
/// Throws   Error{kInput}: no stroke.
/// Cost     a solve of 600 unknowns and a sum over the samples each 8 px of the picture: some 0.1 s. The same
///          field for any number of threads.
/// Source   Okabe et al. 2011, Sec. 5, last paragraph, and Fig. 8; they do not name their radial function.
StrokeField interpolate(const std::vector<Stroke>& strokes, cv::Size picture,
                        const std::string& where = "strokes", const StrokeFieldOptions& options = {});

}  // namespace freshet::hints
