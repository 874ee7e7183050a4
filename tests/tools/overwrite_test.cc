// An output that is an input, under whatever name: refused before anything is computed.

#include <gtest/gtest.h>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

class Overwrite : public testing::Test {
 protected:
  Overwrite() {
    fs::copy_file(sample().still, folder_ / "still.png");
    fs::copy_file(sample().matte, folder_ / "matte.png");
    fs::copy_file(sample().clips / "river/1.mkv", folder_ / "river.mkv");
    copy_of_store(folder_, "a.store");
    fs::create_hard_link(folder_ / "still.png", folder_ / "hard.png");
    fs::create_symlink("matte.png", folder_ / "soft.png");
    fs::create_symlink("a.store", folder_ / "soft.mkv");
    fs::create_directories(folder_ / "frames");
    fs::copy_file(sample().still, folder_ / "frames/00001.png");
  }
  void expect_refusal(const std::vector<std::string>& arguments) {
    const Outcome outcome = folder_.freshet(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments[1] << ": " << outcome.err;
    EXPECT_NE(outcome.err.find("it would be written over"), std::string::npos) << outcome.err;
  }
  WorkFolder folder_;
};

TEST_F(Overwrite, IsRefusedByEveryCommandThatWrites) {
  const std::string still = text_of(folder_ / "still.png"), matte = text_of(folder_ / "matte.png"),
                    store = text_of(folder_ / "a.store"), frame = text_of(folder_ / "frames/00001.png");
  expect_refusal({"synth", "matte", "still.png", "--box", "5,5,90,90", "-o", "still.png"});
  expect_refusal({"synth", "matte", "still.png", "--box", "5,5,90,90", "-o", "hard.png"});
  expect_refusal({"synth", "matte", "still.png", "--scribbles", "matte.png", "-o", "soft.png"});
  expect_refusal(
      {"synth", "matte", "still.png", "--box", "5,5,90,90", "-o", "new.png", "--sheet", "./still.png"});
  expect_refusal({"query", "label", "a.store", "still.png", "-o", "a.store"});
  expect_refusal({"query", "label", "a.store", "still.png", "--matte", "matte.png", "--map", "soft.png"});
  expect_refusal({"query", "candidates", "a.store", "still.png", "--sheet", "hard.png"});
  expect_refusal({"synth", "animate", "a.store", "still.png", "-o", "soft.mkv"});
  expect_refusal({"synth", "animate", "a.store", "frames/00001.png", "-o", "frames/%05d.png"});
  expect_refusal({"synth", "animate", "a.store", "still.png", "--sheet", "still.png", "-o", "new.mkv"});
  expect_refusal({"synth", "transfer", "--exemplar", "river.mkv", "--design", ".", "-o", "river.mkv"});
  expect_refusal({"synth", "transfer", "--exemplar", "frames", "--design", ".", "-o", "frames/%05d.png"});
  expect_refusal({"synth", "flowlines", "river.mkv", "-o", "river.mkv", "--overwrite"});
  expect_refusal({"synth", "flowlines", "river.mkv", "-o", "new.mkv", "--lines", "hard.png", "--lines-out",
                  "still.png", "--overwrite"});
  expect_refusal({"synth", "tour", "still.png", "-o", "new.mkv", "--draw", "still.png", "--overwrite"});
  expect_refusal({"store", "export", "a.store", "river/1.mkv", "-o", "soft.mkv"});
  folder_.file("scene.toml", "");
  expect_refusal({"synth", "simulate", "scene.toml", "-o", "scene.toml"});
  expect_refusal({"synth", "scene", "scene.toml", "-o", "new.mkv", "--layers-out", "scene.toml"});
  folder_.file("options.toml", "[synth.matte]\noutput = \"still.png\"\n");
  expect_refusal({"--config", "options.toml", "synth", "matte", "still.png", "--box", "5,5,90,90"});
  EXPECT_TRUE(text_of(folder_ / "still.png") == still);
  EXPECT_TRUE(text_of(folder_ / "matte.png") == matte);
  EXPECT_TRUE(text_of(folder_ / "a.store") == store);
  EXPECT_TRUE(text_of(folder_ / "frames/00001.png") == frame);
}

TEST_F(Overwrite, AnOutputOfAnEarlierRunMayBeReplaced) {
  std::vector<std::string> sheet{"query",    "candidates", "a.store", "still.png",
                                 "--frames", "16",         "--sheet", "out.png"};
  EXPECT_EQ(folder_.freshet(sheet).exit_code, 0);
  EXPECT_EQ(folder_.freshet(sheet).exit_code, 2);
  sheet.push_back("--overwrite");
  const Outcome outcome = folder_.freshet(sheet);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

}  // namespace
}  // namespace freshet::tools
