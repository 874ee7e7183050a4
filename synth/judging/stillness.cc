#include "synth/judging/stillness.h"

#include <opencv2/imgproc.hpp>

namespace freshet::synth::judging {

Reading stillness(const Evidence& film) {
  cv::Mat sum = cv::Mat::zeros(film.size(), CV_64F), squares = cv::Mat::zeros(film.size(), CV_64F);
  for (const cv::Mat& luma : film.luma()) {
    cv::accumulate(luma, sum);
    cv::accumulateSquare(luma, squares);
  }
  const double n = film.count();
  const cv::Mat variance = squares / n - (sum / n).mul(sum / n);
  cv::Mat still;
  cv::Mat(variance < 1).convertTo(still, CV_32F, 1.0 / 255);
  return {.value = cv::mean(still, film.fluid())[0], .map = {cell_means(still, film.matte())}};
}

}  // namespace freshet::synth::judging
