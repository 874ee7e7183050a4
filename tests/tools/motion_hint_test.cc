// The motion that is guessed where nobody asks for any, and what overrules it.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

constexpr const char* kGuessed = "direction guessed for";

class MotionHint : public testing::Test {
 protected:
  Outcome query(const std::string& what, std::vector<std::string> more) const {
    std::vector<std::string> arguments{"query",   what,           sample().store, sample().still,
                                       "--matte", sample().matte, "--frames",     "16"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }

  WorkFolder folder_;
};

TEST_F(MotionHint, IsGuessedSaidAndDrawn) {
  const Outcome found = query("candidates", {"--class", "fall", "--draw", "arrows.png"});
  ASSERT_EQ(found.exit_code, 0) << found.err;
  EXPECT_NE(found.err.find(kGuessed), std::string::npos) << found.err;
  EXPECT_NE(found.err.find("100 % fall (goes down in this store)"), std::string::npos) << found.err;
  EXPECT_NE(found.err.find("--hint none"), std::string::npos) << found.err;
  EXPECT_EQ(cv::imread(folder_ / "arrows.png").size(), cv::Size(kWidth, kHeight));
  const Outcome labelled = query("label", {"--class", "fall"});
  ASSERT_EQ(labelled.exit_code, 0) << labelled.err;
  EXPECT_NE(labelled.err.find(kGuessed), std::string::npos) << labelled.err;
}

TEST_F(MotionHint, IsOverruledByWhateverAPersonAsks) {
  folder_.file("down.svg", "<svg viewBox='0 0 192 144'><path d='M90 20q4 50 0 100'/></svg>");
  for (const std::vector<std::string>& asked : std::vector<std::vector<std::string>>{
           {"--hint", "none"}, {"--direction", "down"}, {"--strokes", "down.svg"}}) {
    std::vector<std::string> arguments{"--class", "fall"};
    arguments.insert(arguments.end(), asked.begin(), asked.end());
    const Outcome outcome = query("label", arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("guess"), std::string::npos) << outcome.err;
  }
}

TEST_F(MotionHint, IsAutoOrNone) {
  const Outcome outcome = query("label", {"--hint", "please"});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_NE(outcome.err.find("--hint"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace freshet::tools
