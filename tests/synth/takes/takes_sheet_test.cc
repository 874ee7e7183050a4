#include "synth/takes/takes_sheet.h"

#include <gtest/gtest.h>

#include "tests/synth/takes/trial_scene.h"

namespace freshet::synth::takes {
namespace {

TEST(TakesSheet, HasARowATakeAndStandsBelowTheFilms) {
  const TrialScene scene;
  const Trial trial = try_takes(scene.subject(), {{.name = "as asked"}, {.name = "faster", .speed = 2}},
                                {.side = 96, .frames = 16});
  const cv::Mat sheet = takes_sheet(trial);
  ASSERT_EQ(sheet.type(), CV_8UC3);
  const int row = sheet.rows / 2;
  // The last frames of both rows differ, as their films do.
  const cv::Rect last(sheet.cols * 4 / 5, 4, sheet.cols / 5 - 8, 40);
  EXPECT_GT(cv::norm(sheet(last), sheet(last + cv::Point(0, row)), cv::NORM_INF), 8);
  const cv::Mat film(50, 600, CV_8UC3, cv::Scalar(1, 2, 3)), both = with_takes(film, trial);
  EXPECT_EQ(both.rows, film.rows + sheet.rows);
  EXPECT_EQ(both.cols, std::max(film.cols, sheet.cols));
  EXPECT_EQ(cv::norm(both(cv::Rect({0, 0}, film.size())), film, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace freshet::synth::takes
