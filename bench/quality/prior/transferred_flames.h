// quality/prior/transferred_flames.h — a still's own flames by appearance transfer, a rival of our renderers of fire.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "store/store.h"
#include "synth/animate/forms/parted_still.h"

namespace freshet::bench {

/// Flames of clips where those of a still burn: what a transfer is designed by.
struct FlameDesign {
  synth::animate::PartedStill still;
  std::vector<cv::Mat> levels;       // CV_32F, 0..1, the still's size: one more than frames are made
  std::vector<store::ClipId> clips;  // that burn, one for each fire of the still
  double fit = 0;                    // of them, 0..1
};

/// Clips chosen and laid on the still's flames by bed, axis, height and the overlap of their mean light (plan_forms),
/// their levels matched to the still's by height (LevelMaps).
/// picture  CV_32FC3, sRGB code. alpha  CV_32F. clips  that may burn.
/// flow_step  of the store's settings. fps  of the animation: clips play in their own time.
/// Throws   Error{kInput}: the still has no flames, or no clip has.
FlameDesign design_of_flames(const store::Snapshot& snapshot, int flow_step, const cv::Mat& picture,
                             const cv::Mat& alpha, std::span<const store::ClipId> clips, int frames,
                             double fps);

/// The still's light as exemplar, the design's levels as alpha, their flow as motion; over the still's ground, which
/// stands. Frame 0 is the still; where the matte is 0 all frames are.
/// still    CV_8UC3. matte CV_8U, its size. parted  of it.
/// levels   as FlameDesign: at least two. The first is not shown: flames go from the still's to the second.
/// Returns  one frame fewer than there are levels, CV_8UC3. All threads; the same for any number.
/// Throws   Error{kInput}: the still has too few flames for an exemplar. Error{kIo}: no folder for temporary files.
/// Cost     .3 s of CPU for a frame of 640 x 360 px.
/// Source   Jamriska et al. 2015, "LazyFluids", by synth/transfer with its defaults. Their exemplar is matted by a
///          person, their motion designed or simulated; here the exemplar is parted from the still, and alpha and
///          motion are another clip's. Not as there: alpha is how bright a flame is, up to half of the brightest, and
///          what is transferred is light, which is added to the ground.
std::vector<cv::Mat> transfer_flames(const cv::Mat& still, const cv::Mat& matte,
                                     const synth::animate::PartedStill& parted,
                                     std::span<const cv::Mat> levels);

}  // namespace freshet::bench
