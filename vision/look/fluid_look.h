// vision/look/fluid_look.h — how the fluid of a still looks: figures of its colour, detail, edges, place and
// surroundings.
#pragma once

#include <array>
#include <string_view>

#include <opencv2/core.hpp>

namespace freshet::vision {

/// In the order of fluid_look; colours and luma in 0..1, "blue" and "red" less luma.
inline constexpr std::array<std::string_view, 21> kLookFigures{
    "luma_mean",
    "red_mean",
    "red_spread",
    "black_share",         // of luma below .1
    "white_share",         // of luma above .85
    "warm_share",          // of flames' reds and yellows
    "chroma_spread",       //
    "saturation_spread",   //
    "blue_share",          // bluer than red
    "grey_share",          //
    "detail",              // log of the contrast of detail below 2 px
    "coarseness",          // log of that of detail of 8 to 16 px, less detail
    "fineness",            // detail, less the log of the luma's spread
    "coherence",           // 1 where edges of 6 px run alike
    "height",              // of the fluid's middle: -.5 at the top, .5 at the bottom
    "aspect",              // log of width over height
    "ring_luma",           // fluid less what is within 10 px of it
    "ring_blue",           //
    "red_on_luma",         // slope; a flame turns from red to yellow as it gets brighter
    "blue_on_luma",        //
    "saturation_on_luma",  //
};
using FluidLook = std::array<float, kLookFigures.size()>;

/// On the picture reduced or enlarged to a longer side of 256 px.
/// picture   CV_8UC3 BGR. matte   CV_8U of its size, 255 where the fluid is; all is fluid where nothing is.
/// Cost      8 ms at 640 x 480, one thread.
FluidLook fluid_look(const cv::Mat& picture, const cv::Mat& matte);

}  // namespace freshet::vision
