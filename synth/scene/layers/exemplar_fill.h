// synth/scene/layers/exemplar_fill.h — a hole filled with patches of what lies near it.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

struct FillOptions {
  int patch_px = 9;    // side of a patch, odd, 3 to 33
  int search_px = 48;  // a patch is searched this far from the place that it fills, to each side
};

/// What is where in a picture that is to be filled. All CV_8U, 255 or 0, of the picture's size.
struct Hole {
  cv::Mat known;  // what stands, and is continued
  cv::Mat
      target;  // what is filled; never known. What is neither stays as it is, and nothing is concluded from it
  cv::Mat source;  // what may be copied; a part of known
};

struct Filled {
  cv::Mat picture;  // CV_32FC3: the picture, with copies in the target
  cv::Mat
      source;  // CV_32SC2: where each pixel comes from; its own place where it is known; (-1, -1) unfilled
  cv::Mat
      filled;  // CV_8U, 255: the part of the target that could be filled; all that touches something known,
               // as long as one whole patch of the source is there
};

/// Patch after patch, from where most is known and where edges run into the hole: there the patch of the source
/// that is most like what is known (sum of squared differences in CIE Lab) is copied into what is not.
///
/// picture   CV_32FC3, sRGB code.
/// Where no whole patch of the source lies within search_px, it is looked for twice as far, and again.
/// Throws    Error{kUsage} for a patch of another size than said above.
/// Cost      .1 ms for each patch of 9 px copied, at 48 px of search, on a thread; some 25 of its pixels are new. The
///           same for any number of threads: candidates of one patch are compared at once, patches go one by one.
/// Source    Criminisi, Perez, Toyama 2003, Object removal by exemplar-based inpainting (priority: Eq. 1 and what
///           follows it). Two deviations: sources near the hole only, as Chuang et al. 2005, Sec. 2, have it; and a
///           thousandth is added to the data term, or confidence would count for nothing where nothing is seen.
Filled exemplar_fill(const cv::Mat& picture, const Hole& hole, const FillOptions& options = {});

}  // namespace freshet::synth::scene
