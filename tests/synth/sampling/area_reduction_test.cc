#include "synth/sampling/area_reduction.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "synth/sampling/cells.h"

namespace freshet::synth::sampling {
namespace {

TEST(AreaReduction, IsOpenCvsInEachRectangleAndReadsNoMoreThanItSays) {
  for (const cv::Size source : {cv::Size(128, 96), cv::Size(317, 211)})
    for (const double scale : {0.5, 0.75, 0.6, 1.0}) {
      cv::Mat plane(source, CV_32F), expected;
      cv::RNG random(3);
      random.fill(plane, cv::RNG::UNIFORM, 0, 1);
      const cv::Size reduced(cvRound(source.width * scale), cvRound(source.height * scale));
      cv::resize(plane, expected, reduced, 0, 0, cv::INTER_AREA);
      const AreaReduction reduction(source, reduced);
      ASSERT_EQ(reduction.reduced(), reduced);
      for (const cv::Rect rect :
           {cv::Rect(0, 0, 5, 7), cv::Rect(11, 13, 20, 9),
            cv::Rect(reduced.width - 6, reduced.height - 3, 6, 3), cv::Rect({}, reduced)}) {
        cv::Mat alone(source, CV_32F, cv::Scalar(1e6)), out(reduced, CV_32F, cv::Scalar(0));
        plane(reduction.source_of(rect)).copyTo(alone(reduction.source_of(rect)));
        std::vector<float> line;
        reduction.apply(alone, rect, out, line);
        EXPECT_LT(cv::norm(out(rect), expected(rect), cv::NORM_INF), 1e-5) << source << scale << rect;
      }
    }
}

TEST(Cells, AreThoseThatRectanglesTouch) {
  const cv::Rect within(10, 20, 70, 50);
  const std::vector<cv::Rect> rects{
      {10, 20, 1, 1}, {41, 35, 2, 2}, {75, 60, 50, 50}, {0, 0, 5, 5}, {20, 20, 0, 4}};
  const std::vector<cv::Rect> cells = cells_touched(rects, within, {32, 16});
  const std::vector<cv::Rect> expected{{10, 20, 32, 16}, {42, 20, 32, 16}, {10, 36, 32, 16},
                                       {42, 36, 32, 16}, {74, 52, 6, 16},  {74, 68, 6, 2}};
  EXPECT_EQ(cells, expected);
}

}  // namespace
}  // namespace freshet::synth::sampling
