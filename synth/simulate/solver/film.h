// synth/simulate/solver/film.h — linear light in, an 8-bit picture out.
#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

#include "synth/field/grid.h"

namespace freshet::synth::simulate {

struct FilmOptions {
  float exposure = 1.0f;
  float bloom = 0.0f;  // fraction of the light that spreads, radius about a fortieth of the picture's height
  /// Triangular noise, levels of 8 bits: below what the eye sees, enough that slow gradients do not band.
  float grain = 1.1f;
};

/// What a scene draws on.
/// light   as large as the picture; 1 is a bright diffuse surface, there is no upper end.
class Film {
 public:
  Film(cv::Size size, const FilmOptions& options, std::uint64_t seed);

  GridOf<Rgb> light;

  /// Bloom, tone curve (Narkowicz 2015, fitted to ACES), gamma 2.2, grain of this frame, rounding.
  /// picture   CV_8UC3 BGR, made if needed.
  void develop(int frame, cv::Mat& picture);

 private:
  void spread();

  FilmOptions options_;
  std::uint32_t seed_;
  GridOf<Rgb> small_, blurred_;
  std::array<float, 2049> curve_;  // of the root of the light
};

}  // namespace freshet::synth::simulate
