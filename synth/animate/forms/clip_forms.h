// synth/animate/forms/clip_forms.h — a clip of fire as it shines, frame by frame, reduced.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/forms/seats.h"

namespace freshet::synth::animate {

/// Light is luma above this often what a place shows at its darkest: what a fire lights beats with it, and is not to
/// shine.
inline constexpr float kLit = 2;

/// What forms are chosen by.
struct ClipForms {
  store::ClipId clip{};
  cv::Size source;  // px of a frame
  double fps = 25;
  double by = 1;                // px of the source that a sample is wide and high
  std::vector<cv::Mat> levels;  // of each frame's light, CV_8U
  cv::Mat mean;                 // CV_32F, 0..1: the level of their mean light
  double as_one = 0;            // of all change over time, what goes up and down together everywhere, 0..1
  std::vector<Seat>
      seats;  // of the mean, in samples; where there are several, all of them together come last
};

/// Frames are read once, in slabs; at most `most` of them. Samples are so many that the longer side has
/// kFormSamples. Throws Error{kDamaged} as stored::ClipFrames.
ClipForms clip_forms(const store::Snapshot& snapshot, store::ClipId clip, std::uint32_t most);
inline constexpr int kFormSamples = 224;

/// Share of the variance over time that its first principal component has, 0..1. Of flames, whose tongues burn each for
/// itself, .1 to .4; a candle's glass, or a wall, is lit as a whole: .5 and more.
/// levels  CV_8U, at least one.
/// Cost    of some 48 of them at an eighth of the samples.
double beats_as_one(const std::vector<cv::Mat>& levels);

/// The darkest that each place shows, but for one frame in ten: of frames of CV_8U luma, CV_8U. Where it never gets
/// dark and does not stand still, or is clipped, there is always a flame: there it is continued from around.
cv::Mat darkest(const std::vector<cv::Mat>& frames);

}  // namespace freshet::synth::animate
