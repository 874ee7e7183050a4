// What stands where a command would write is kept, unless it is given up.

#include <gtest/gtest.h>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A little river of so many frames.
Outcome river(const WorkFolder& folder, const std::string& out, int frames = 3,
              std::vector<std::string> more = {}) {
  std::vector<std::string> arguments{
      "synth", "simulate", "river", "--size", "64x48", "--frames", std::to_string(frames), "-o", out};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return folder.freshet(arguments);
}

void expect_kept(const Outcome& outcome, const std::string& part) {
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_TRUE(holds(outcome.err, part)) << outcome.err;
}

TEST(Outputs, AFileThatExistsIsKeptUntilItIsGivenUp) {
  const WorkFolder folder;
  folder.file("mine.mkv", "mine");
  expect_kept(river(folder, "mine.mkv"), "mine.mkv: it exists, and is kept. Name another file, or replace");
  EXPECT_EQ(text_of(folder / "mine.mkv"), "mine");
  EXPECT_EQ(river(folder, "mine.mkv", 3, {"--overwrite"}).exit_code, 0);
  EXPECT_NE(text_of(folder / "mine.mkv"), "mine");
}

TEST(Outputs, FoldersAreMade) {
  const WorkFolder folder;
  EXPECT_EQ(river(folder, "shots/fall/%04d.png").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "shots/fall/0002.png"));
  EXPECT_EQ(river(folder, "films/a/b.mkv").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder / "films/a/b.mkv"));
  folder.file("file", "");
  const Outcome outcome = river(folder, "file/b.mkv");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(holds(outcome.err, "the folder file cannot be made")) << outcome.err;
}

TEST(Outputs, NoFrameOfAnotherRunStandsAmongOurs) {
  const WorkFolder folder;
  ASSERT_EQ(river(folder, "s/%04d.png", 5).exit_code, 0);
  expect_kept(river(folder, "s/%04d.png", 5), "0000.png: this and 4 more frames exist, and are kept");
  // Two older frames would follow the last of three.
  expect_kept(river(folder, "s/%04d.png", 3, {"--overwrite"}), "0003.png: a frame of another run");
  EXPECT_EQ(river(folder, "s/%04d.png", 5, {"--overwrite"}).exit_code, 0);
  EXPECT_EQ(river(folder, "s/####.png", 5, {"--overwrite"}).exit_code, 0);
}

TEST(Outputs, AnimateKeepsAllThatItWouldWrite) {
  const WorkFolder folder;
  const std::vector<std::string> command{"synth",   "animate",      sample().store, sample().still,
                                         "--matte", sample().matte, "--frames",     "4",
                                         "-o",      "made/out.mkv"};
  const auto with = [&](std::vector<std::string> more) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder.freshet(arguments);
  };
  ASSERT_EQ(with({"--sheet", "made/sheets/a.png"}).exit_code, 0);
  ASSERT_TRUE(fs::exists(folder / "made/sheets/a.png"));
  const std::string first = text_of(folder / "made/out.mkv");
  expect_kept(with({}), "made/out.mkv: it exists, and is kept");
  folder.file("mine.png", "mine");
  fs::rename(folder / "made/out.mkv", folder / "made/other.mkv");
  for (const char* output : {"--sheet", "--speed-out", "--orientation-out", "--draw"})
    expect_kept(with({output, "mine.png"}), "mine.png: it exists, and is kept");
  EXPECT_EQ(text_of(folder / "mine.png"), "mine");
  EXPECT_FALSE(fs::exists(folder / "made/out.mkv"));
  ASSERT_EQ(with({"--overwrite"}).exit_code, 0);
  EXPECT_EQ(text_of(folder / "made/out.mkv"), first);
}

TEST(Outputs, EveryOtherCommandKeepsThemToo) {
  const WorkFolder folder;
  const fs::path mine = folder.file("mine.png", "mine");
  const std::vector<std::vector<std::string>> commands{
      {"query", "candidates", sample().store, sample().still, "--sheet", "mine.png"},
      {"query", "label", sample().store, sample().still, "-o", "mine.png"},
      {"query", "label", sample().store, sample().still, "--map", "mine.png"},
      {"query", "bench", sample().store, "--page", "mine.png"},
      {"synth", "matte", sample().still, "--box", "10,10,50,50", "-o", "mine.png"},
      {"store", "export", sample().store, "fall/1.mkv", "-o", "mine.png"}};
  for (const std::vector<std::string>& command : commands)
    expect_kept(folder.freshet(command), "mine.png: it exists, and is kept");
  expect_kept(folder.freshet({"synth", "sweep", sample().store, sample().still, "--whole", "--vary",
                              "sigma=1,2", "-o", "."}),
              "something lies in this folder, and is kept");
  EXPECT_EQ(text_of(mine), "mine");
}

}  // namespace
}  // namespace freshet::tools
