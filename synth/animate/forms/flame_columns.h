// synth/animate/forms/flame_columns.h — where the flames of a picture stand, column by column, and how far up they are.
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace freshet::synth::animate {

// Of all of them, level: CV_32F, 0..1, of the picture's light (PartedStill::level).

/// Levels above are flames.
inline constexpr float kShines = 0.1f;

/// The lowest row of flames that are no specks, even over neighbouring columns; -1 where there are none.
std::vector<float> beds_of(const cv::Mat& level);

/// CV_32F, 0..1: where light may be. Within a tenth of the longer side of flames, less up to twice that, but not below
/// them: what burns before a log or a rim has its foot there, and copies that begin farther down do not show through.
cv::Mat reach_of(const cv::Mat& level);

/// CV_32F, 0..1: of each column's highest flame, 0 in its lowest fifth and below, 1 in its highest and above. Even over
/// neighbouring columns; far from all flames as of their mean.
cv::Mat tips_of(const cv::Mat& level);

}  // namespace freshet::synth::animate
