// synth/animate/still/lost_contrast.h — the contrast that mixed copies of a picture lose, brought back.
#pragma once

#include <span>

#include <opencv2/core.hpp>

#include "synth/animate/motion/copy_maps.h"
#include "synth/animate/still/standing_detail.h"
#include "synth/animate/still/standing_layout.h"

namespace freshet::synth::animate {

struct LostContrastOptions {
  /// Band-pass levels whose contrast is brought back, as many as the picture has: detail up to 2^levels px.
  int levels = 5;
  /// Copies agree in detail of 1 px (the finest band) where their sources lie this far apart, px, or nearer.
  double agreement_px = 0.9;
  /// No band is amplified by more. Three copies that agree in nothing lose 1.73, but most places show one: with 1.75
  /// clouds and plumes had .03 to .09 more of log2 energy than with 1.25, and were further from the footage in every
  /// band; without any, flames lost their coarse forms.
  double max_gain = 1.2;
};

/// A mixture of n copies of one texture that do not agree has less contrast than the texture: weights a_k give it
/// the variance a' C a, C the copies' correlations. How far two copies agree is known from their maps: where their
/// sources lie d apart, a band of wavelength in proportion to l agrees by exp(-d^2 / (2 l^2)). Each band is divided
/// by the root of a' C a, place by place, so that slow places, where all copies agree, stay as they are. Nothing is
/// fitted: no frame depends on another.
/// renewed  by level, finest first: the fraction of the band's variance that is left for what comes anew, 0..1;
///          beyond its end 0.
/// where    CV_32F, sampled as the maps: how much of that fraction a place leaves, 0..1. Empty: 1.
/// standing what of each level is the picture's own, in its place. What is carried gives way to it: with c the
///          correlation of both, s and a their weights, s^2 + a^2 + 2 s a c = 1, so that contrast stays as it is. s is
///          the share times 1 - c: what has hardly moved goes on, not half of it. The low-pass rest has a mean, and is
///          mixed as s and 1 - s. Then the level as a whole takes the picture's magnitude (StandingDetail::match).
/// begun    how far the frame has left the still, 0..1: to this power the magnitude is matched. The still is as it is.
/// luma     CV_32F, the picture's size; changed in place.
/// copies   of this frame; step px of the picture between samples of their maps.
/// Cost     one Laplacian pyramid of the picture. Safe from many threads.
void restore_contrast(cv::Mat& luma, std::span<const CopyMap> copies, int step,
                      std::span<const double> renewed, const cv::Mat& where, const StandingDetail& standing,
                      double begun, const LostContrastOptions& options);

/// The same of a texture: `luma` is what the copies bring of StandingLayout::texture, and becomes the frame's. Each
/// band takes the magnitude of its place, and lies over what stands there.
void lay_texture(cv::Mat& luma, std::span<const CopyMap> copies, int step, std::span<const double> renewed,
                 const cv::Mat& where, const StandingLayout& layout, const LostContrastOptions& options);

}  // namespace freshet::synth::animate
