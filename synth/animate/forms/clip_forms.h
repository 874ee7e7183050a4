// synth/animate/forms/clip_forms.h — a clip of fire as it shines, frame by frame, reduced.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/forms/seats.h"

namespace freshet::synth::animate {

/// Light is luma above this often what a place shows at its darkest: what a fire lights beats with it, and is not to shine.
inline constexpr float kLit = 2;

/// What forms are chosen by.
struct ClipForms {
  store::ClipId clip{};
  cv::Size source;  // px of a frame
  double fps = 25;
  double by = 1;                // px of the source that a sample is wide and high
  std::vector<cv::Mat> levels;  // of each frame's light, CV_8U
  cv::Mat mean;                 // CV_32F, 0..1: the level of their mean light
  std::vector<Seat>
      seats;  // of the mean, in samples; where there are several, all of them together come last
};

/// Frames are read once, in slabs; at most kMaxFormFrames of them. Samples are so many that the longer side has
/// kFormSamples. Throws Error{kDamaged} as stored::ClipFrames.
ClipForms clip_forms(const store::Snapshot& snapshot, store::ClipId clip);
inline constexpr int kFormSamples = 224;
inline constexpr std::uint32_t kMaxFormFrames = 480;

/// The darkest that each place shows, but for one frame in ten: of frames of CV_8U luma, CV_8U. Where it never gets dark
/// and does not stand still, or is clipped, there is always a flame: there it is continued from around.
cv::Mat darkest(const std::vector<cv::Mat>& frames);

}  // namespace freshet::synth::animate
