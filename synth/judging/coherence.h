// synth/judging/coherence.h — combing: whether a film is drawn out into strands that the still does not have.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/judging/evidence.h"
#include "synth/judging/reading.h"

namespace freshet::synth::judging {

/// Indices of up to 16 frames, evenly spread from the first to the last.
std::vector<std::size_t> spread_frames(std::size_t frames);

/// Coherence of the structure tensor (Sobel, blurred by sigma 6 px) of the spread frames, weighted by its strength, in
/// the matte: 1 where all is streaks, 0 where no direction stands out. Torn flames lose it.
/// luma   CV_8U, all of one size. matte CV_8U of it, counted where above 127.
double mean_coherence(std::span<const cv::Mat> luma, const cv::Mat& matte);

/// Coherence of each cell less the still's there, mean over cells and spread frames: above 0 the fluid is combed. Cells
/// count alike, for strands have little strength.
Reading combing(const Evidence& film);

}  // namespace freshet::synth::judging
