#include "report/sheet_words.h"

#include <gtest/gtest.h>

namespace freshet::report {
namespace {

int ink(const cv::Mat& sheet, const cv::Rect& at) {
  cv::Mat grey;
  cv::extractChannel(sheet(at), grey, 0);
  return cv::countNonZero(grey > 120);
}

TEST(SheetWords, AMaskIsShownWithSomeOfWhatLiesAroundIt) {
  cv::Mat mask(400, 600, CV_8U, cv::Scalar(0));
  EXPECT_EQ(shown_region(mask), cv::Rect(0, 0, 600, 400)) << "of nothing all";
  mask(cv::Rect(100, 50, 100, 200)).setTo(1);
  EXPECT_EQ(shown_region(mask), cv::Rect(84, 34, 132, 232));
  EXPECT_EQ(crop_words(shown_region(mask), mask.size()),
            "Cropped to the matte: 132 x 232 px at 84, 34 of 600 x 400.");
  EXPECT_EQ(crop_words({0, 0, 600, 400}, mask.size()), "");
}

TEST(SheetWords, ALegendIsBrokenIntoLinesThatFitAndLeavesTheSheetAsItWas) {
  const cv::Mat sheet(50, 200, CV_8UC3, cv::Scalar::all(7));
  const cv::Mat one = with_legend(sheet, {"Short."});
  const cv::Mat more = with_legend(
      sheet, {"Words that are far too long to stand in one line of so narrow a sheet.", "", "End."});
  EXPECT_EQ(one.cols, 200);
  EXPECT_GE(more.rows, one.rows + 2 * kSheetLine);
  EXPECT_EQ(cv::norm(more(cv::Rect(0, 0, 200, 50)), sheet, cv::NORM_INF), 0);
  for (int y = 50; y + kSheetLine <= more.rows; y += kSheetLine)
    EXPECT_GT(ink(more, {0, y, 200, kSheetLine}), 5) << y;
  EXPECT_EQ(ink(more, {196, 50, 4, more.rows - 50}), 0) << "no word is cut at the edge";
  EXPECT_EQ(with_legend(sheet, {}).rows, 50);
}

TEST(SheetWords, ACaptionThatDoesNotFitIsCut) {
  cv::Mat sheet(kSheetLine, 300, CV_8UC3, cv::Scalar::all(0));
  write_caption(sheet, "a caption that is much longer than the room that it was given here", {2, 13}, 100);
  EXPECT_GT(ink(sheet, {0, 0, 100, kSheetLine}), 20);
  EXPECT_EQ(ink(sheet, {104, 0, 196, kSheetLine}), 0);
}

}  // namespace
}  // namespace freshet::report
