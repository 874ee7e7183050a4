// freshet ingest of films: what it would take, what it says, and its page.

#include <gtest/gtest.h>

#include <filesystem>

#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "media/video/video_writer.h"
#include "tests/ingest/synthetic_clip.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using ingest::SyntheticClip;
using nlohmann::json;

const std::string kName = "a <b> & \"c\".mkv";

/// A take that stands, one that pans, and one of half a second.
class IngestTool : public testing::Test {
 protected:
  IngestTool() {
    fs::create_directories(folder_ / "water");
    const SyntheticClip still{.size = {192, 144}, .frames = 40, .changing = true, .coarse = true};
    SyntheticClip panned = still, brief = still;
    panned.pan = {1.5, 0};
    panned.seed = 2;
    brief.frames = 12;
    brief.seed = 3;
    media::VideoWriter writer(folder_ / ("water/" + kName), still.size, {.fps_num = 25});
    cv::Mat bgr;
    for (const SyntheticClip& take : {still, panned, brief})
      for (const cv::Mat& frame : ingest::render(take)) {
        cv::cvtColor(frame, bgr, cv::COLOR_GRAY2BGR);
        writer.write(bgr);
      }
    writer.finish();
  }
  Outcome ingest(std::vector<std::string> more) const {
    std::vector<std::string> arguments{"ingest", "s.store", "water"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  const WorkFolder folder_;
};

TEST_F(IngestTool, ADryRunSaysWhatTheRunThenDoesAndWritesNothing) {
  const Outcome dry = ingest({"--dry-run", "--json"});
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_FALSE(fs::exists(folder_ / "s.store"));
  const json would = json::parse(dry.out).at("clips");
  ASSERT_EQ(would.size(), 3u);
  EXPECT_EQ(would[0].at("outcome"), "would be added");
  EXPECT_EQ(would[1].at("outcome"), "refused");
  EXPECT_EQ(
      would[1].at("help").at(0),
      "Put the camera on a tripod, or lean it on something that stands; --steady makes steady what can be");
  EXPECT_EQ(would[2].at("help").at(0), "Film for four seconds or more at a time");
  EXPECT_TRUE(would[0].at("kind").is_string());

  const Outcome real = ingest({"--json", "--no-index"});
  ASSERT_EQ(real.exit_code, 0) << real.err;
  const json did = json::parse(real.out).at("clips");
  ASSERT_EQ(did.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(did[i].at("name"), would[i].at("name"));
    EXPECT_EQ(did[i].at("part"), would[i].at("part"));
    EXPECT_EQ(did[i].at("reasons"), would[i].at("reasons"));
  }
  EXPECT_EQ(did[0].at("outcome"), "added");
  const std::string before = digest(folder_ / "s.store");
  const Outcome again = ingest({"--dry-run"});
  EXPECT_NE(again.out.find("1 already there"), std::string::npos) << again.out;
  EXPECT_EQ(digest(folder_ / "s.store"), before);
}

TEST_F(IngestTool, ThePageShowsEachPartAndNeedsNothingElse) {
  const Outcome dry = ingest({"--dry-run", "--page", "page.html"});
  ASSERT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_NE(dry.out.find("1.6 s of 3.7 s would be taken, as 1 clip"), std::string::npos) << dry.out;
  const std::string page = text_of(folder_ / "page.html");
  EXPECT_NE(page.find("<h2 class=\"film\">a &lt;b&gt; &amp; &quot;c&quot;.mkv</h2>"), std::string::npos);
  for (const char* never : {"<b> &", "http", "src=\"/", "{{"})
    EXPECT_EQ(page.find(never), std::string::npos) << never;
  std::size_t pictures = 0;
  for (std::size_t at = 0; (at = page.find("src=\"data:image/jpeg;base64,/9j/", at)) != std::string::npos;
       ++at)
    ++pictures;
  EXPECT_EQ(pictures, 3u);
  for (const char* said : {"0.00 to 1.60 s", "would be added", "the camera moves", "Film for four seconds"})
    EXPECT_NE(page.find(said), std::string::npos) << said;
  EXPECT_NE(ingest({"--dry-run", "--page", "page.html"}).exit_code, 0) << "it is kept";
  EXPECT_EQ(ingest({"--dry-run", "--page", "page.html", "--overwrite"}).exit_code, 0);
}

TEST_F(IngestTool, NoOptionIsPassedOver) {
  EXPECT_NE(ingest({"--dry-run", "--no-index"}).exit_code, 0);
  EXPECT_NE(ingest({"--dry-run", "--no-flann"}).exit_code, 0);
  EXPECT_NE(ingest({"--dry-run", "--licence", "CC0"}).exit_code, 0);
  EXPECT_NE(ingest({"--overwrite"}).exit_code, 0);
}

TEST_F(IngestTool, ADryRunRefusesAStoreThatTheRunCouldNotMake) {
  for (const char* store : {"none/s.store", "s.stores"}) {
    const Outcome run = folder_.freshet({"ingest", store, "water"}),
                  dry = folder_.freshet({"ingest", store, "water", "--dry-run"});
    EXPECT_NE(run.exit_code, 0);
    EXPECT_EQ(dry.exit_code, run.exit_code) << store;
    EXPECT_EQ(dry.err, run.err) << store;
    EXPECT_EQ(dry.out, "") << store;
  }
}

TEST_F(IngestTool, OfNothingThatIsFitADryRunEndsAsTheRunDoes) {
  fs::remove(folder_ / ("water/" + kName));
  ingest::write_clip(folder_ / "water/brief.mkv", {.frames = 12});
  EXPECT_EQ(ingest({"--dry-run"}).exit_code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "s.store"));
}

}  // namespace
}  // namespace freshet::tools
