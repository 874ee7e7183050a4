// clip_analysis.h — what of a clip moves, and the patches that are kept of it.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "stored/clip_columns.h"
#include "vision/settings.h"
#include "vision/temporal_spectrum.h"

namespace freshet::ingest {

/// Mean and standard deviation over time of every pixel's luma. Sums are integers: exact for any order.
class LumaStatistics {
 public:
  explicit LumaStatistics(cv::Size frame);
  void add(const cv::Mat& luma);  // CV_8U; all threads
  cv::Mat mean_u16() const;       // CV_16U, 0..65535
  cv::Mat deviation() const;      // CV_32F, luma in 0..1

 private:
  std::uint32_t frames_ = 0;
  cv::Mat sum_;                         // CV_32S: full after 8.4 million frames
  std::vector<std::uint64_t> squares_;  // row-major
};

/// 255 where a clip moves, CV_8U at source size: mean speed of at least settings.min_motion_px (px per frame
/// at 25 frames per second) and deviation of at least settings.min_change. Flow alone drags still scenery
/// along beside a jet; change alone counts flicker and noise. Then closed and opened with a 5 px disc: holes
/// and specks narrower than that are noise of either measure, patches of 48 px never depend on them.
/// mean_speed_px   as vision::MotionAccumulator gives it: px per frame, possibly smaller than the source.
cv::Mat moving_mask(const cv::Mat& mean_speed_px, const cv::Mat& deviation, double fps,
                    const vision::Settings& settings);

/// Patches that lie wholly inside the source, of which at least settings.min_coverage moves, and that nothing crossed.
/// moving    CV_8U at source size.
/// crossed   the same (CrossingFinder); empty: nothing did.
/// Without words. All threads; the same for any number.
stored::PatchColumns find_patches(const cv::Mat& moving, const cv::Mat& crossed,
                                  const vision::CellMap& motion, const vision::Settings& settings);

/// The smallest side, px, of a frame in which a patch of the largest scale fits.
int min_side(const vision::Settings& settings);

}  // namespace freshet::ingest
