#include "query/search/picture_scale.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "freshet/error.h"
#include "query/index/index_builder.h"
#include "query/labelling/labelling.h"
#include "tests/stored/made_store.h"

namespace freshet::query {
namespace {

TEST(PictureScale, IsOneForMostPicturesAndGrowsInHalves) {
  EXPECT_EQ(auto_piece_scale({640, 480}), 1);
  EXPECT_EQ(auto_piece_scale({1400, 900}), 1);
  EXPECT_EQ(auto_piece_scale({1080, 1920}), 1.5);
  EXPECT_EQ(auto_piece_scale({2560, 1440}), 2);
  EXPECT_EQ(auto_piece_scale({3840, 2160}), 3);
  EXPECT_EQ(auto_piece_scale({100000, 10}), kMaxPieceScale);
  for (int side = 1600; side < 16000; side += 7)
    EXPECT_LE(std::abs(side / auto_piece_scale({side, 100}) - 1280), 220) << side;
}

TEST(PictureScale, ReducesPicturesAndSpeedsAlike) {
  EXPECT_EQ(reduced_size({3840, 2160}, 3), cv::Size(1280, 720));
  EXPECT_EQ(reduced_size({5, 3}, 16), cv::Size(1, 1));
  EXPECT_THROW(reduced_size({5, 3}, 0.5), Error);
  const cv::Mat picture(90, 120, CV_8UC3, cv::Scalar(10, 20, 30));
  EXPECT_EQ(reduce(picture, 1).data, picture.data);
  EXPECT_EQ(cv::norm(reduce(picture, 1.5), cv::Mat(60, 80, CV_8UC3, cv::Scalar(10, 20, 30)), cv::NORM_INF),
            0);

  MotionGuide guide{.direction = cv::Mat(90, 120, CV_32FC2, cv::Scalar(0.6, 0.8)),
                    .speed = cv::Mat(90, 120, CV_32F, cv::Scalar(60))};
  guide.direction(cv::Rect(0, 0, 60, 90)).setTo(0);
  guide.speed(cv::Rect(0, 0, 59, 90)).setTo(-1);  // one column of an area of three is asked
  const MotionGuide small = reduce(guide, 3);
  ASSERT_EQ(small.direction.size(), cv::Size(40, 30));
  EXPECT_EQ(small.direction.at<cv::Vec2f>(10, 19), cv::Vec2f(0, 0));
  EXPECT_NEAR(cv::norm(small.direction.at<cv::Vec2f>(10, 20)), 1, 1e-5);
  EXPECT_LT(small.speed.at<float>(10, 18), 0);
  EXPECT_NEAR(small.speed.at<float>(10, 19), 20, 1e-4);
  EXPECT_NEAR(small.speed.at<float>(10, 20), 20, 1e-4);
}

TEST(PictureScale, AnEnlargedPictureFindsWhatTheReducedOneFinds) {
  const ScratchFolder folder;
  store::Store store = made_store(folder.path() / "a.store", some_clips());
  build_index(store);
  const SearchBase base = open_search(store.snapshot());
  cv::Mat grey = made_texture(2), small, large;
  cv::cvtColor(grey, small, cv::COLOR_GRAY2BGR);
  cv::resize(small, large, {}, 3, 3, cv::INTER_NEAREST);
  LabelOptions options;
  const auto labelled = [&](const cv::Mat& picture, double scale) {
    options.piece_scale = scale;
    return label(store.snapshot(), base, picture, cv::Mat(picture.size(), CV_8U, cv::Scalar(255)), options)
        .assignment;
  };
  const Assignment of_small = labelled(small, 1), of_large = labelled(large, 3);
  EXPECT_EQ(of_small.pieces, of_large.pieces);
  EXPECT_EQ(of_large.picture, large.size());
  EXPECT_EQ(of_large.piece_scale, 3);

  // The file: who only knows version 1 must not read it, and scale 1 is written as it ever was.
  EXPECT_NE(to_json(of_large).find("\"version\": 2"), std::string::npos);
  EXPECT_EQ(assignment_from_json(to_json(of_large), "here"), of_large);
  EXPECT_NE(to_json(of_small).find("\"version\": 1"), std::string::npos);
  EXPECT_EQ(to_json(of_small).find("piece_scale"), std::string::npos);
  EXPECT_EQ(assignment_from_json(to_json(of_small), "here"), of_small);
  for (const double wrong : {0.0, 0.5, 16.5}) {
    nlohmann::json json = nlohmann::json::parse(to_json(of_large));
    json["piece_scale"] = wrong;
    EXPECT_THROW(assignment_from_json(json.dump(), "here"), Error) << wrong;
  }
  // Pieces are near the reduced picture, not the whole one.
  nlohmann::json json = nlohmann::json::parse(to_json(of_large));
  for (nlohmann::json& piece : json["pieces"]) piece["x"] = piece["x"].get<int>() + 8 * 24;
  EXPECT_THROW(assignment_from_json(json.dump(), "here"), Error);
}

}  // namespace
}  // namespace freshet::query
