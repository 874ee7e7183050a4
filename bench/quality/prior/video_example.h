// quality/prior/video_example.h — a still moved by one video example, the prior work of Okabe et al. 2011.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::bench {

/// A video as mean image, steady flow and residuals: what each frame's difference from the mean adds to that of the
/// frame before, carried along the flow.
struct VideoExample {
  cv::Mat mean;                    // CV_32F, luma, 0..1
  cv::Mat flow;                    // CV_32FC2, px a frame
  cv::Mat contrast;                // CV_32F, of luma: deviation over time
  std::vector<cv::Mat> residuals;  // CV_32F, luma: one for each frame but the first
  double kept = 1;  // of a difference, from one frame to the next: the best for all pixels at once
};

/// frames   CV_8UC3, at least two, as they are to be played: as many a second as the animation has.
/// flow     CV_32FC2, px a frame: their mean motion, of any size (stretched to theirs).
/// Cost     12 bytes a pixel and frame. All threads; the same for any number.
/// Source   Okabe et al. 2009, "Animating Pictures of Fluid using Video Examples", of whose decomposition Okabe et al.
///          2011, Sec. 1 and 7.1, tell. Not as there: `kept` is found (they: 1, after which in a still of other flow
///          differences grow without end).
VideoExample decompose(std::span<const cv::Mat> frames, const cv::Mat& flow);

/// Differences of a still from its long exposure, carried along the motion, to which in each frame the example's
/// residuals come; then histograms are matched to the still's. Frame 0 is the still; where the matte is 0 all frames
/// are.
/// still    CV_8UC3. matte CV_8U, its size.
/// motion   CV_32FC2, px/s, its size: what was asked.
/// Returns  `frames` frames, CV_8UC3; residuals begin again where the example ends. All threads; the same for any
///          number. Memory: 7 bytes a pixel and frame.
/// Cost     .04 s of CPU for a frame of 256 x 144 px.
/// Source   As above; base_image, AppearanceModel and ColourModel for their long exposure, histograms and colours. Not
///          as there: the squares of 32 px from which residuals come are those most alike in mean luma, contrast and
///          speed, and not those of their neighbours (they: a person's choice), turned so that they flow as asked; the
///          flow is not refined by the still's edges; only luma is transferred, as in our rendering of the later paper.
std::vector<cv::Mat> animate_by_example(const cv::Mat& still, const cv::Mat& matte, const cv::Mat& motion,
                                        double fps, const VideoExample& example, int frames);

}  // namespace freshet::bench
