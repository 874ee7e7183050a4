// synth/scene/rendering/cyclic_texture.h — a picture that goes on beyond its sides until it comes round.
#pragma once

#include <opencv2/core.hpp>

namespace freshet::synth::scene {

/// A texture that is periodic along x and begins with the picture.
///
/// colour   CV_32FC3. known   CV_8U of its size, 255 where colour stands: there it comes back to the bit.
/// period   px, at least the picture's width + 2: the columns beyond the picture join its right end to its left one.
/// Returns  CV_32FC3 of the picture's height and this width. What is not known, beyond the picture and in it, is copied
///          from what is: exemplar_fill with patches of 9 px, at 960 px of width at most, the copies then taken from
///          the picture itself. Clouds that an end cuts go on, and nothing is mirrored. (At 112 px whole clouds were
///          copied, but edges did not meet, and the ends had to be joined by their own mirror images: seen at once.)
///          Where nothing can be copied it is continued smoothly.
/// Cost     some .1 s for each 100 x 100 reduced px to be filled. The same for any number of threads.
/// Source   Chuang et al. 2005, Sec. 3.5.
cv::Mat cyclic_texture(const cv::Mat& colour, const cv::Mat& known, int period);

}  // namespace freshet::synth::scene
