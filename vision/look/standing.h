// vision/look/standing.h — what stands inside a matte, as a still shows it: a guess.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include <opencv2/core.hpp>

namespace freshet::vision {

/// In the order of standing_figures; colours in units of CIE Lab, L of 0..100. "Near": within some 20 px of the
/// matte's border, holes' too.
inline constexpr std::array<std::string_view, 10> kStandingFigures{
    "beside",           // share of what is no fluid within 12 px
    "edge",             // 1 at the matte's border, 1/e 5 px from it
    "background",       // log of how frequent the colour is beside the fluid, less that of how frequent in it
    "nearby",           // nearer to the colour beside the fluid than to the fluid's, within 12 px
    "detail",           // log of the contrast of detail below 2 px, less the fluid's median
    "height",           // -.5 at the top of the fluid, .5 at its bottom
    "near_dark",        // near, and darker than the fluid within 35 px, in its deviations
    "near_unlike",      // near, and off the fluid's colour within 12 px
    "near_background",  // near, and "background" where that is positive
    "near_hue",         // near, and off the fluid's median in a and b, in its deviations
};

/// The figures of each pixel, CV_32F, of the picture reduced or enlarged to a longer side of 640 px.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size, fluid above 127, somewhere.
std::vector<cv::Mat> standing_figures(const cv::Mat& picture, const cv::Mat& matte);

/// The picture's own frame, an edge of scan or canvas: sides whose outermost 10 px, at a longer side of 640 px, end in
/// a step of colour all along them. CV_8U of the picture's size, 255 in it.
cv::Mat own_frame(const cv::Mat& picture);

/// What looks as if it stood in the matte: its own frame, round things (round_things.h), and what is more like things
/// that were drawn as standing in pictures than like the fluid around them, of these at most a tenth of the matte.
/// Rather misses than takes fluid.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size, fluid above 127.
/// Returns   CV_8U of the picture's size: 255 where it stands, its rim soft; 0 outside of the matte.
/// Cost      .19 s of CPU at 640 px. docs/measurements/first_takes.md says how often it is right.
cv::Mat what_stands(const cv::Mat& picture, const cv::Mat& matte);

}  // namespace freshet::vision
