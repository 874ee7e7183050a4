// synth/animate/motion/motion_field.h — the mean motion that an assignment gives to every pixel.
#pragma once

#include <opencv2/core.hpp>

#include "query/search/motion_guide.h"
#include "store/store.h"
#include "synth/animate/placement/placement.h"
#include "vision/settings.h"

namespace freshet::synth::animate {

/// Mean motion over the picture: CV_32FC2, px/s, x right, y down. Cells of the assigned patches, weighted
/// towards each piece's middle and interpolated; zero where no piece lies.
cv::Mat motion_field(const store::Snapshot& snapshot, const vision::Settings& settings,
                     const Placement& placement, cv::Size picture);

/// A field that shears little: neighbouring patches of clips that went at other speeds, or elsewhere, would comb a
/// cloud to hair, and wind up the lights in a river. Way and speed become means over the fluid around, of sigma .15 of
/// the longer side; but what rests beside what goes there (over some .05, by less than .3 of its mean speed, wholly; to
/// .8, in part) keeps its own, and does not count (to .5, in part): a narrow stream through still water keeps its
/// speed. Where ways cancel out (a mean below .1 of the mean speed) each place keeps its way, and is brought to that
/// speed by what lies within some .05, at most fourfold; between (to .3) what goes against the mean is slowed.
/// motion    CV_32FC2, px/s.
/// matte     CV_32F, 0..1, of that size.
/// whole     0..1: how far what rests goes along with the rest.
/// Returns   CV_32FC2, px/s; beside the fluid evened too.
/// Cost      some passes over the field, one thread.
cv::Mat evened_motion(const cv::Mat& motion, const cv::Mat& matte, double whole);

/// The fastest that an animation is carried where a speed is asked, px/s: .8 of the picture's longer side a second. In
/// 39 clips the fastest fluid is a fountain's: 99 % of its places go by less than .77 on the average, where a fall's go
/// by .3. What is asked beyond would tear or fade: at 1000 px/s flames of 640 px became fog.
double fastest_speed(cv::Size picture);

/// An assigned field turned to where a guide asks it to go and, where speeds are asked, as fast: a patch goes
/// only about as asked, and with its own eddies, and no faster than fastest_speed(). Where the guide says nothing the
/// field stays.
/// With a horizon the patches' own speeds, where none are asked, shrink towards it; their mean over the fluid stays.
/// motion   CV_32FC2, px/s; guide of the same size, or empty. matte: CV_32F, 0..1, of that size.
cv::Mat apply_guide(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& matte);

/// Water that falls gathers speed, and water that is thrown up loses it: by v^2 = v0^2 + 2 g h along its way, where a
/// way is asked, and neither a speed nor a horizon (unasked, lamps mirrored in a lake would fall: they are drawn out
/// upright too). The scale is not known: v at the foot is twice that at the brink, and water that rises ends with a
/// third of its speed. So clips do: a fountain falls by 7 to 12 px a frame over 160 px, its square by the height to a
/// tenth, a fall by 6 to 10 between two ledges. The mean speed becomes .35 of the longer side a second, as falls have
/// (.71 and .19 in those two), but no less than the patches' own and at most four times that: of falling spray their
/// flow sees a fifth.
/// What falls freely: a stretch within 25 degrees of upright, a quarter of the picture's height or more, whose texture
/// is drawn out upright. Of the squares of gradients .58 to .88 lie across in four such (two falls, a fountain, a
/// geyser), .09 to .40 in brooks, rapids, rivers and falls that are seen from afar.
/// motion   CV_32FC2, px/s, as apply_guide made it; luma and matte CV_32F, 0..1, of its size.
/// played   > 0: how fast the patches play, 1 as filmed. The fall goes so many times as fast.
/// Cost     some passes over the field, one thread.
cv::Mat falling_freely(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& luma,
                       const cv::Mat& matte, double played = 1);

/// What was thrown up and comes down again.
struct ComingDown {
  // Both go over, across the stretch's ends and some 6 px (of 640) beyond, to the motion that was given and to 0.
  cv::Mat motion;  // CV_32FC2, px/s. Empty: nothing is thrown up.
  cv::Mat share;   // CV_32F, 0..1: how far a place shows it
};

/// Water that falling_freely() lets rise, and that ends in the open above, comes down beside its core: at every height
/// as fast as it rose there, and on sideways. So a fountain does: its jets rise by 5, 8 and 12 px a frame where, as
/// high up, drops fall by 6, 8 and 10.
/// motion   CV_32FC2, px/s, as falling_freely() made it; luma and matte CV_32F, 0..1, of its size.
/// Cost     as falling_freely().
ComingDown coming_down(const cv::Mat& motion, const query::MotionGuide& guide, const cv::Mat& luma,
                       const cv::Mat& matte);

/// How many times as fast the fluid goes as the patches that were assigned to it, in 1/4..4: the mean of the logarithm
/// over the matte, faster places by their speed. 1 where nothing moves.
/// assigned, asked   CV_32FC2, px/s, of one size; matte CV_8U, > 0 where the fluid is.
double pace(const cv::Mat& assigned, const cv::Mat& asked, const cv::Mat& matte);

}  // namespace freshet::synth::animate
