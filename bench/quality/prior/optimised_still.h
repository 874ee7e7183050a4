// quality/prior/optimised_still.h — a still moved by texture optimisation, a rival of Okabe et al. 2011 (Sec. 7.1).
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

/// The fluid of a still, made anew in each frame of its own patches, so that it looks like the frame before, carried on
/// along a steady field. Frame 0 is the still; where the matte is 0 all frames are.
/// still    CV_8UC3, at least 18 px per side. matte CV_8U, its size.
/// flow     CV_32FC2, px a frame, its size.
/// Returns  `frames` frames, CV_8UC3. All threads; the same for any number.
/// Throws   Error{kInput}: the matte is black. Error{kIo}: the folder for temporary files cannot be written to.
/// Cost     .3 s of CPU for a frame of 256 x 144 px that is all fluid.
/// Source   Kwatra et al. 2005, "Texture Optimization for Example-based Synthesis", Sec. 3 (EM of neighbourhoods,
///          coarse to fine) and 4.2 (flow), by synth/transfer with the nearest patch for the uniform one. Not as
///          there: patches are 9 px wide at each level (they: 32, 16 and 8); the carried frame counts in the search
///          alone, as much as the patch itself (they: in the vote too); patches of the matte's soft edge stay at it.
///          Patches lie on whole pixels: of fluid that goes less than 2 px a frame on the average only every so many
///          frames is optimised that it goes as far, and those between are carried.
std::vector<cv::Mat> optimise_still(const cv::Mat& still, const cv::Mat& matte, const cv::Mat& flow,
                                    int frames);

}  // namespace freshet::bench
