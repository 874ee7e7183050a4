// freshet store page: what it says of a store, and of pictures that are asked of it.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

using nlohmann::json;
using testing::Contains;
using testing::HasSubstr;

TEST(StorePage, ShowsEachClipAndSaysWhatIsMissing) {
  const WorkFolder folder;
  const Outcome outcome =
      folder.freshet({"store", "page", sample().store.string(), "-o", "page.html", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json said = json::parse(outcome.out);
  ASSERT_EQ(said["clips"].size(), 3u);
  for (const json& clip : said["clips"]) {
    EXPECT_GT(clip["sides_per_second"], 0.01) << clip;
    EXPECT_GT(clip["light"], 0.02) << clip;
    EXPECT_GE(clip["alike"], 0.0) << clip;
    EXPECT_LE(clip["alike"], 1.0) << clip;
  }
  // Two falls look more like each other than the river like them.
  EXPECT_GT(said["clips"][0]["alike"], said["clips"][2]["alike"]);
  EXPECT_THAT(said["lacks"], Contains(json("No water.")));  // its classes are fall and river
  const std::string page = text_of(folder / "page.html");
  for (const char* word : {"fall/1.mkv", "river/1.mkv", "--frames:", "data:image/jpeg;base64,", "No clouds."})
    EXPECT_THAT(page, HasSubstr(word));
  EXPECT_EQ(folder.freshet({"store", "page", sample().store.string(), "-o", "page.html"}).exit_code, 2)
      << "the page is there";
}

TEST(StorePage, APictureUnlikeTheStoreIsSaidToBe) {
  const WorkFolder folder;
  cv::Mat checks(kHeight, kWidth, CV_8UC3);
  for (int y = 0; y < checks.rows; ++y)
    for (int x = 0; x < checks.cols; ++x)
      checks.at<cv::Vec3b>(y, x) = cv::Vec3b::all((x / 3 + y / 3) % 2 * 255);
  cv::imwrite((folder / "checks.png").string(), checks);
  cv::Mat lower(kHeight, kWidth, CV_8U, cv::Scalar(255));
  lower.rowRange(0, 20).setTo(0);
  cv::imwrite((folder / "lower.png").string(), lower);
  // Falls alone: what is like them is much liker than what is not.
  const std::string falls = copy_of_store(folder).string();
  ASSERT_EQ(folder.freshet({"store", "remove", falls, "river/1.mkv"}).exit_code, 0);
  ASSERT_EQ(folder.freshet({"index", falls}).exit_code, 0);
  const std::vector<std::string> words{"store",     "page",      falls,       "-o",
                                       "page.html", "--json",    "--picture", sample().still.string(),
                                       "--picture", "checks.png"};
  std::vector<std::string> with = words;
  with.insert(with.end(), {"--matte", sample().matte.string(), "--matte", "lower.png"});
  const Outcome outcome = folder.freshet(with);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json said = json::parse(outcome.out);
  EXPECT_LT(said["pictures"][0]["unlike"], 0.5) << "another waterfall";
  EXPECT_GT(said["pictures"][1]["unlike"], 0.9);
  EXPECT_THAT(said["lacks"].dump(), HasSubstr("checks.png"));
  std::vector<std::string> one = words;
  one.insert(one.end(), {"--matte", "lower.png", "--overwrite"});
  const Outcome refused = folder.freshet(one);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("not as many mattes as pictures"));
}

}  // namespace
}  // namespace freshet::tools
