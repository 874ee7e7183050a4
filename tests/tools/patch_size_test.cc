// The whole job with stores of other patches than 48 px.

#include <gtest/gtest.h>

#include <algorithm>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kClipFrames = 32, kAnimated = 16;

cv::Mat mean_of(const std::vector<cv::Mat>& frames) {
  cv::Mat sum;
  for (const cv::Mat& frame : frames) {
    cv::Mat wide;
    frame.convertTo(wide, CV_64F);
    sum = sum.empty() ? wide : cv::Mat(sum + wide);
  }
  return sum / static_cast<double>(frames.size());
}

/// Two clips of fluid and a store of them with patches of one size, with the average image of the first.
class PatchSize : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    for (const char* name : {"clips", "frames"}) fs::create_directories(folder_ / name);
    const auto simulate = [&](const char* preset, const std::string& out) {
      must({"synth", "simulate", preset, "--size", "192x144", "--frames", std::to_string(kClipFrames), "-o",
            out});
    };
    simulate("waterfall", "clips/fall.mkv");
    simulate("waterfall", "frames/%05d.png");
    simulate("river", "clips/river.mkv");
    // Patches of the whole frame, so that each piece has its own in the store.
    must({"ingest", "a.store", "clips", "--patch", size(), "--min-coverage", "0", "--scales", "1,0.5",
          "--rotations", "0,22.5"});
    cv::Mat average;
    mean_of(read_frames(folder_ / "frames")).convertTo(average, CV_8U);
    cv::imwrite(folder_ / "average.png", average);
  }
  std::string size() const { return std::to_string(GetParam()); }
  void must(const std::vector<std::string>& arguments) const {
    const Outcome outcome = folder_.freshet(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  json label(const std::string& picture, const std::string& threads) const {
    must({"query", "label", "a.store", picture, "--hint", "none", "--frames", std::to_string(kAnimated), "-j",
          threads, "-o", "assignment.json", "--overwrite"});
    return json::parse(text_of(folder_ / "assignment.json"));
  }
  std::vector<cv::Mat> animate(const std::string& picture, const std::string& threads) const {
    fs::create_directories(folder_ / threads);
    must({"synth", "animate", "a.store", picture, "--whole", "--frames", std::to_string(kAnimated),
          "--assignment", "assignment.json", "-j", threads, "-o", threads + "/%05d.png"});
    return read_frames(folder_ / threads);
  }

  WorkFolder folder_;
};

TEST_P(PatchSize, APictureThatIsInTheStoreIsAnimatedByItself) {
  const json one = label("average.png", "1");
  EXPECT_EQ(one, label("average.png", "2"));
  EXPECT_EQ(one["side"], GetParam());
  EXPECT_EQ(one["stride"], GetParam() / 2);
  int own = 0;
  for (const json& piece : one["pieces"])
    own += one["clips"][piece["clip"].get<int>()]["name"] == "fall.mkv" && piece["patch_x"] == piece["x"] &&
           piece["patch_y"] == piece["y"] && piece["scale"] == 1 && piece["rotation_deg"] == 0 &&
           piece["flip"] == false;
  EXPECT_GE(own, 0.95 * static_cast<double>(one["pieces"].size()))
      << own << " of " << one["pieces"].size() << " pieces";
}

TEST_P(PatchSize, FramesAreTheSameForAnyNumberOfThreadsAndShowNoGrid) {
  must({"synth", "simulate", "waterfall", "--size", "192x144", "--frames", "1", "--seed", "7", "-o",
        "still.png"});
  label("still.png", "2");
  const std::vector<cv::Mat> one = animate("still.png", "1"), two = animate("still.png", "2");
  ASSERT_EQ(one.size(), static_cast<std::size_t>(kAnimated));
  ASSERT_EQ(two.size(), one.size());
  for (std::size_t i = 0; i < one.size(); ++i)
    ASSERT_EQ(cv::norm(one[i], two[i], cv::NORM_INF), 0) << "frame " << i;

  // Steps across the borders at which pieces hand over, against steps everywhere else, of what moves.
  const int stride = GetParam() / 2;
  const cv::Mat mean = mean_of(one);
  double at_border = 0, elsewhere = 0;
  int borders = 0, others = 0;
  for (const cv::Mat& frame : one) {
    cv::Mat moving;
    frame.convertTo(moving, CV_64F);
    moving -= mean;
    for (int x = 1; x < moving.cols; ++x) {
      const double step = cv::norm(moving.col(x), moving.col(x - 1), cv::NORM_L1);
      const bool border = (x + stride / 2) % stride == 0;
      (border ? at_border : elsewhere) += step;
      ++(border ? borders : others);
    }
  }
  ASSERT_GT(borders, 0);
  ASSERT_GT(elsewhere, 0);
  EXPECT_LT(at_border / borders, 1.25 * elsewhere / others);
}

INSTANTIATE_TEST_SUITE_P(Patches, PatchSize, testing::Values(24, 32, 48, 96),
                         [](const auto& tested) { return std::to_string(tested.param); });

}  // namespace
}  // namespace freshet::tools
