// synth/animate/still/continued.h — a picture's fluid, gone on with beyond its sides.
#pragma once

#include <opencv2/core.hpp>

#include "synth/animate/still/fluid_planes.h"

namespace freshet::synth::animate {

/// By how much a picture is continued, px: multiples of 8, each at most a quarter of its length there.
struct Sides {
  int left = 0, right = 0, top = 0, bottom = 0;
};

struct ContinuedFluid {
  FluidPlanes planes;
  cv::Mat matte;     // CV_32F, 0..1
  cv::Rect picture;  // where the picture itself lies in both, unchanged
};

/// Sides over which the fluid goes, in or out (a copy that is as the picture only later brings what will have gone
/// out), by a quarter each; others by 0.
/// motion   CV_32FC2, px/s; matte CV_32F, 0..1, of one size.
/// step     of the copies' maps: sides are multiples of it.
Sides crossed_sides(const cv::Mat& motion, const cv::Mat& matte, int step);

/// Beyond a side the picture goes on as elsewhere in itself. Mirrored alone a cloud comes in as its own twin, head to
/// head. The side is parted into six blocks; each is followed by the place that goes on best from the block's own end,
/// is fluid where that is, lies within the picture, far from the side and at most an eighth of its length higher or
/// lower, and goes best with its neighbours' (exact, by dynamic programming; at a longer side of 160 px). Next to the
/// side, as far as a copy may read it for its own (sampling::kRims), lies the picture's mirror image. A narrow mirrored
/// band, and seams where both are most alike, blended by bands (Burt and Adelson 1983), join them. Light that is wider
/// than a tenth of the longer side (sigma) is mirrored all the way.
/// Cost     some .1 s of CPU a side at 640 px, one thread. Memory: 20 bytes a pixel of what is made and as many of each
///          part that is added.
/// Source   shifts of the picture as labels: Pritch et al. 2009, here one a block; seams: Efros and Freeman 2001.
ContinuedFluid continued(const FluidPlanes& planes, const cv::Mat& matte, const Sides& by);

}  // namespace freshet::synth::animate
