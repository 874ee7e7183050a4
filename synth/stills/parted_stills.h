// synth/stills/parted_stills.h — stills parted into a thing that passes in front, and what lies behind it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/stills/still_set.h"

namespace freshet::synth::stills {

/// A thing in front, taken out of every still.
struct FrontThing {
  std::vector<cv::Mat> light;  // by still, of its type: the thing's colours times alpha
  std::vector<cv::Mat> alpha;  // by still, of its type, three equal channels; all bits: the thing covers all
  std::vector<cv::Mat>
      small;  // by still, at work size, CV_8UC3: over grey, for planning and for a person to see
};

/// The matte of each still, CV_8U as its picture lies; all 0 where the folder has none of its name: the thing is not
/// seen there.
/// folder   of pictures named as the stills are, but for the ending: white, or opaque, where the thing is.
/// Throws   Error{kInput} naming file, fault and remedy: unreadable, in colour, of another size than the stills, none
///          for any.
std::vector<cv::Mat> front_mattes(const std::filesystem::path& folder, const StillSet& set);

/// How much of each pixel is replaced where a thing is taken out, CV_32F: 1 where it is, falling to 0 four px beside
/// it, for a matte is seldom exact. matte   CV_8U.
cv::Mat replaced_share(const cv::Mat& matte);

/// Takes the thing out. What it hides comes from the still that is most alike where neither is hidden, of those that
/// show the place; where none does, it is made up from around it (inpaint_background), which the notices say.
///
/// With B that filled still, C = a F + (1 - a) B gives the thing's light a F, so that within the matte a still put
/// together again is itself, and the rim carries no colour of what lay behind it. Lin et al. 2007, Sec. 7 leave layers
/// to others.
/// pictures   CV_8UC3 or CV_16UC3 of one size; replaced by what lies behind. mattes   as front_mattes gives them.
/// farther    by still, CV_8U: above 0 lies another thing, which fills nothing; empty: none does.
/// Cost       O(stills^2) for a pixel that is hidden; in memory some three times the stills more while they are parted.
/// Throws     Error{kInput} where things hide all of every still.
FrontThing part_stills(std::vector<cv::Mat>& pictures, const std::vector<cv::Mat>& mattes,
                       const std::vector<cv::Mat>& farther, const std::string& name,
                       std::vector<std::string>& notices);

/// The thing over a middle grey, CV_8UC3: what orders and flow are found on.
cv::Mat over_grey(const cv::Mat& light, const cv::Mat& alpha);

}  // namespace freshet::synth::stills
