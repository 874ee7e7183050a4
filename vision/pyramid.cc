#include "vision/pyramid.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "freshet/error.h"

namespace freshet::vision {

void laplacian_pyramid(const cv::Mat& picture, int levels, std::vector<cv::Mat>& bands) {
  if (picture.empty() || levels < 0) {
    throw Error(ErrorKind::kUsage, "pyramid", "a picture and a number of levels from 0 expected");
  }
  bands.resize(static_cast<std::size_t>(levels) + 1);
  cv::Mat rest, smaller, blurred;
  picture.convertTo(rest, CV_32F);
  for (int level = 0; level < levels; ++level) {
    cv::pyrDown(rest, smaller);
    cv::pyrUp(smaller, blurred, rest.size());
    cv::subtract(rest, blurred, bands[level]);
    cv::swap(rest, smaller);
  }
  rest.copyTo(bands[levels]);
}

int levels_within(cv::Size picture, int wanted) {
  constexpr int kLeastRest = 4;
  while (wanted > 0 && (std::min(picture.width, picture.height) >> wanted) < kLeastRest) --wanted;
  return wanted;
}

cv::Mat collapse(const std::vector<cv::Mat>& bands) {
  if (bands.empty()) throw Error(ErrorKind::kUsage, "pyramid", "no bands to collapse");
  cv::Mat picture = bands.back().clone(), larger;
  for (std::size_t level = bands.size() - 1; level-- > 0;) {
    cv::pyrUp(picture, larger, bands[level].size());
    cv::add(larger, bands[level], picture);
  }
  return picture;
}

}  // namespace freshet::vision
