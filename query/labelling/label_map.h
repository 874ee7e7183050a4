// query/labelling/label_map.h — a picture coloured by the clips that animate it.
#pragma once

#include <opencv2/core.hpp>

#include "query/labelling/assignment.h"

namespace freshet::query {

/// The picture in grey, each pixel of the fluid tinted by the clip of the nearest piece. Edges between
/// patches that do not continue each other are drawn dark. Below it a legend: each clip with its fraction of
/// the pieces, its class and its licence, most used first (at most 40), and what the colours and lines mean.
/// matte    CV_8U, to which the map is cropped; null: all that pieces cover counts as fluid.
/// Returns  CV_8UC3, as wide as what is shown or 480 px.
cv::Mat label_map(const cv::Mat& picture, const cv::Mat* matte, const Assignment& assignment);

}  // namespace freshet::query
