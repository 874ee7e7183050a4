#include "query/search/target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "freshet/error.h"
#include "tests/harness/fault.h"
#include "tests/stored/made_store.h"
#include "vision/dense_sift.h"

namespace freshet::query {
namespace {

cv::Mat blob(cv::Size size, cv::Rect box) {
  cv::Mat matte(size, CV_8U, cv::Scalar(0));
  matte(box).setTo(255);
  return matte;
}

void expect_all_covered(const cv::Mat& matte, const Target& target) {
  cv::Mat covered(matte.size(), CV_8U, cv::Scalar(0));
  for (const cv::Point& corner : target.corners) {
    covered(cv::Rect(corner, cv::Size(target.side, target.side)) & cv::Rect({0, 0}, matte.size())).setTo(255);
  }
  EXPECT_EQ(cv::countNonZero((matte > 0) & (covered == 0)), 0);
}

TEST(Target, CoversTheWholePictureWhateverItsSize) {
  for (const cv::Size size :
       {cv::Size(48, 48), cv::Size(1, 1), cv::Size(30, 500), cv::Size(100, 73), cv::Size(97, 120)}) {
    const cv::Mat matte(size, CV_8U, cv::Scalar(255));
    const Target target = lay_out(matte, {});
    EXPECT_EQ(static_cast<int>(target.size()), target.columns * target.rows) << size;
    expect_all_covered(matte, target);
    const int span = (target.columns - 1) * 24 + 48;
    EXPECT_LT(span - size.width, std::max(24, 49 - size.width)) << "no more places than it takes";
    EXPECT_LE(target.origin.x, 0);
  }
}

TEST(Target, LiesOnOneLatticeWithNeighboursAsEdges) {
  const cv::Mat matte = blob({301, 211}, {40, 50, 200, 90});
  const Target target = lay_out(matte, {});
  expect_all_covered(matte, target);
  std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
  for (std::uint32_t p = 0; p < target.size(); ++p) {
    EXPECT_EQ(target.corners[p], target.origin + target.places[p] * 24);
    for (std::uint32_t q = p + 1; q < target.size(); ++q) {
      const cv::Point apart = target.corners[q] - target.corners[p];
      if (apart == cv::Point(24, 0) || apart == cv::Point(0, 24)) expected.emplace(p, q);
    }
  }
  EXPECT_EQ(std::set(target.edges.begin(), target.edges.end()), expected);
  EXPECT_EQ(target.edges.size(), expected.size());
}

TEST(Target, KeepsPiecesByTheirShareAndCoversEverySpeck) {
  cv::Mat matte = blob({240, 240}, {96, 96, 48, 48});
  const std::size_t without = lay_out(matte, {}).size();
  EXPECT_EQ(without, 9u);  // fractions: 1, 4 x 1/2, 4 x 1/4
  matte.at<std::uint8_t>(3, 3) = 1;
  matte.at<std::uint8_t>(200, 230) = 1;
  const Target target = lay_out(matte, {});
  EXPECT_EQ(target.size(), without + 2);
  expect_all_covered(matte, target);
}

TEST(Target, RefusesAMatteWithoutFluid) {
  fault_of(ErrorKind::kInput, [&] { lay_out(cv::Mat::zeros(50, 50, CV_8U), {}); });
}

vision::Codebook made_codebook() {
  std::vector<vision::Descriptor> samples = vision::dense_sift(made_texture(9), {0, 0}, 33, 25).values;
  return vision::train_codebook(samples, {.words = 30, .iterations = 3});
}

TEST(Target, DescribesAPieceAsAPatchOfTheSamePixels) {
  const cv::Mat luma = made_texture(5, {240, 192});
  cv::Mat picture;
  cv::cvtColor(luma, picture, cv::COLOR_GRAY2BGR);
  const vision::Codebook codebook = made_codebook();
  const cv::Mat matte(luma.size(), CV_8U, cv::Scalar(255));
  const Target target = make_target(picture, matte, {}, codebook);
  ASSERT_EQ(target.queries.size(), target.size());
  EXPECT_EQ(target.origin, cv::Point(0, 0));
  for (std::size_t p = 0; p < target.size(); ++p) {
    const auto grid = vision::dense_sift(luma, target.corners[p], 9, 9);
    vision::WordMap words;
    vision::assign_words(codebook, grid.values, words);
    EXPECT_EQ(target.queries[p].words, words);
    EXPECT_EQ(std::count(target.queries[p].mask.begin(), target.queries[p].mask.end(), 1), 81);
  }
}

TEST(Target, CountsOnlyPointsInTheFluidAndInThePicture) {
  cv::Mat picture;
  cv::cvtColor(made_texture(6, {150, 100}), picture, cv::COLOR_GRAY2BGR);
  cv::Mat matte = blob(picture.size(), {0, 0, 150, 60});
  const Target target = make_target(picture, matte, {}, made_codebook());
  bool some_left_out = false;
  for (std::size_t p = 0; p < target.size(); ++p) {
    const auto& mask = target.queries[p].mask;
    const auto counted = std::count(mask.begin(), mask.end(), 1);
    EXPECT_GE(counted, 9);
    for (int point = 0; point < 81; ++point) {
      const cv::Point px = target.corners[p] + cv::Point(point % 9, point / 9) * 6;
      const bool inside = cv::Rect(0, 0, 151, 101).contains(px);
      if (!inside) {
        EXPECT_EQ(mask[point], 0) << px;
      }
      if (inside && px.y < 60) {
        EXPECT_EQ(mask[point], 1) << px;
      }
      some_left_out |= mask[point] == 0;
    }
  }
  EXPECT_TRUE(some_left_out);
}

}  // namespace
}  // namespace freshet::query
