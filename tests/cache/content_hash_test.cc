#include "cache/content_hash.h"

#include <gtest/gtest.h>

namespace freshet::cache {
namespace {

TEST(ContentHash, IsOfTheSamplesNotOfWhereTheyLie) {
  cv::Mat picture(5, 7, CV_8UC3);
  cv::randu(picture, 0, 256);
  const Key key = content_hash(picture);
  EXPECT_EQ(content_hash(picture.clone()), key);
  cv::Mat wide(9, 11, CV_8UC3);
  cv::Mat part = wide(cv::Rect(2, 3, 7, 5));
  picture.copyTo(part);
  EXPECT_EQ(content_hash(part), key) << "rows with gaps between them";
}

TEST(ContentHash, ChangesWithEverySampleTheSizeAndTheType) {
  const cv::Mat picture(4, 6, CV_8U, cv::Scalar(9));
  const Key key = content_hash(picture);
  for (int i = 0; i < 24; ++i) {
    cv::Mat other = picture.clone();
    other.data[i] ^= 1;
    EXPECT_NE(content_hash(other), key) << i;
  }
  EXPECT_NE(content_hash(picture.reshape(0, 6)), key);
  EXPECT_NE(content_hash(cv::Mat(4, 6, CV_8S, picture.data)), key);
}

TEST(ContentHash, OfSeveralCountsTheirOrder) {
  const cv::Mat a(2, 2, CV_32F, cv::Scalar(1)), b(2, 2, CV_32F, cv::Scalar(2));
  KeyHash forth, back;
  add_content(forth, a), add_content(forth, b);
  add_content(back, b), add_content(back, a);
  EXPECT_NE(forth.key(), back.key());
}

}  // namespace
}  // namespace freshet::cache
