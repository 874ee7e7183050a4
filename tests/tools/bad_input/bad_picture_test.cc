// Pictures, mattes, assignments and names of outputs that are unfit, and questions that leave nothing to
// choose.

#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

class BadPicture : public testing::Test {
 protected:
  Outcome query(const fs::path& picture, std::vector<std::string> more = {},
                const char* frames = "16") const {
    std::vector<std::string> arguments{"query", "candidates", sample().store, picture, "--frames", frames};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  Outcome animate(std::vector<std::string> more, const char* frames = "16") const {
    std::vector<std::string> arguments{"synth",   "animate",      sample().store, sample().still,
                                       "--matte", sample().matte, "--frames",     frames};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_.freshet(arguments);
  }
  static void expect_failure(const Outcome& outcome, int exit_code,
                             std::initializer_list<const char*> parts) {
    EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    for (const char* part : parts)
      EXPECT_NE(outcome.err.find(part), std::string::npos) << part << "\n" << outcome.err;
  }

  WorkFolder folder_;
};

TEST_F(BadPicture, SixteenBitsAndAlphaAreReducedAndSaid) {
  const cv::Mat still = cv::imread(sample().still);
  cv::Mat deep, alpha(still.size(), CV_8UC4, cv::Scalar::all(255));
  still.convertTo(deep, CV_16U, 257);
  cv::mixChannels(still, alpha, {0, 0, 1, 1, 2, 2});
  cv::imwrite(folder_ / "deep.png", deep);
  cv::imwrite(folder_ / "alpha.png", alpha);
  const Outcome plain = query(sample().still), of_deep = query("deep.png"), of_alpha = query("alpha.png");
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  EXPECT_EQ(of_deep.out, plain.out);
  EXPECT_EQ(of_alpha.out, plain.out);
  EXPECT_NE(of_deep.err.find("deep.png: 16 bits per channel reduced to 8"), std::string::npos) << of_deep.err;
  EXPECT_EQ(of_alpha.err.find("alpha channel"), std::string::npos) << "opaque everywhere: not a word";
}

TEST_F(BadPicture, WhatIsNoPicture) {
  folder_.file("text.png", "No picture.\n");
  expect_failure(query("text.png"), 1, {"text.png: not a picture", "Save it as PNG"});
  expect_failure(query("missing.png"), 1, {"missing.png: there is no such file", "Check the name"});
  expect_failure(query(sample().still, {"--matte", "text.png"}), 1, {"text.png: not a picture"});
}

TEST_F(BadPicture, ALineOfPixelsIsAnimated) {
  for (const cv::Size size : {cv::Size(1, 65535), {3000, 2}, {1, 1}}) {
    cv::Mat line(size, CV_8UC3);
    cv::randu(line, 0, 255);
    cv::imwrite(folder_ / "line.png", line);
    const Outcome outcome = folder_.freshet({"synth", "animate", sample().store, "line.png", "--whole",
                                             "--frames", "2", "-o", "out.mkv", "--overwrite"});
    EXPECT_EQ(outcome.exit_code, 0) << size << outcome.err;
  }
}

TEST_F(BadPicture, AVideoIsNamedAsOne) {
  std::ofstream(folder_ / "clip.mp4") << "whatever";
  for (const Outcome& refused : {query("clip.mp4"), query(sample().still, {"--matte", "clip.mp4"})})
    expect_failure(refused, 1,
                   {"clip.mp4: a video, where a picture is expected", "ffmpeg -ss 1 -i clip.mp4"});
}

TEST_F(BadPicture, AMatteThatDoesNotFit) {
  cv::imwrite(folder_ / "small.png", cv::Mat(60, 90, CV_8U, cv::Scalar(255)));
  cv::imwrite(folder_ / "black.png", cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(0)));
  expect_failure(
      query(sample().still, {"--matte", "small.png"}), 1,
      {"small.png: the matte is 90 x 60, the picture 192 x 144: another shape", "Crop them alike"});
  expect_failure(query(sample().still, {"--matte", "black.png"}), 1,
                 {"black.png", "black everywhere", "white"});
}

TEST_F(BadPicture, AQuestionThatNoPatchAnswers) {
  const Outcome misspelt = query(sample().still, {"--class", "rivr"});
  expect_failure(misspelt, 1,
                 {"sample.store: no clip of class \"rivr\". Did you mean \"river\"?", "classes fall, river"});
  EXPECT_EQ(misspelt.err.find("guessing"), std::string::npos) << misspelt.err;  // before the work
  expect_failure(query(sample().still, {"--class", "fall", "--direction", "up", "--hint-search", "narrow"}),
                 1, {"sample.store: no patch moves in direction 90 degrees", "greater tolerance"});
  expect_failure(query(sample().still, {"--exclude", "nosuch"}), 1,
                 {"sample.store: it holds no clip named \"nosuch\"", "freshet store info"});
  expect_failure(query(sample().still, {"--index", "flann-kdtree"}), 1,
                 {"sample.store: it has no FLANN index", "freshet index --flann kdtree"});
}

TEST_F(BadPicture, AnOutputThatCannotBeIsSaidBeforeTheWork) {
  folder_.file("none", "");  // where a folder would have to be
  const auto expect_early = [](const Outcome& outcome, int exit_code, const char* part) {
    expect_failure(outcome, exit_code, {part});
    EXPECT_EQ(outcome.err.find("reading the index"), std::string::npos) << outcome.err;
  };
  expect_early(animate({"-o", "none/%05d.png"}), 1, "none/%05d.png: the folder none cannot be made");
  expect_early(animate({"-o", "none/a.mp4"}), 1, "none/a.mp4: the folder none cannot be made");
  expect_early(animate({"-o", "a.xyz"}), 2, "a.xyz: the ending \".xyz\" names no video format");
  expect_early(animate({"-o", "a.mp4", "--sheet", "none/a.png"}), 1,
               "none/a.png: the folder none cannot be made");
  EXPECT_FALSE(fs::exists(folder_ / "a.mp4"));
  expect_early(query(sample().still, {"--sheet", "none/a.png"}), 1, "the folder none cannot be made");
  expect_early(query(sample().still, {"--sheet", "a.xyz"}), 2, "a.xyz: the ending \".xyz\"");
  const auto label = [&](const char* option, const char* name) {
    return folder_.freshet(
        {"query", "label", sample().store, sample().still, "--frames", "16", option, name});
  };
  expect_early(label("-o", "none/a.json"), 1, "none/a.json: the folder none cannot be made");
  expect_early(label("-o", "."), 2, ".: it is a folder");
  expect_early(label("--map", "none/a.png"), 1, "none/a.png: the folder none cannot be made");
  expect_early(label("--sheet", "a"), 2, "a: the ending");
}

TEST_F(BadPicture, AnAssignmentThatDoesNotFit) {
  ASSERT_EQ(folder_
                .freshet({"query", "label", sample().store, sample().still, "--frames", "16", "--class",
                          "fall", "-o", "good.json"})
                .exit_code,
            0);
  const auto use = [&](const char* name) { return animate({"-o", "out.mkv", "--assignment", name}); };
  folder_.file("garbage.json", "{\"format\": ");
  folder_.file("list.json", "[1, 2]");
  folder_.file("other.json", "{}");
  expect_failure(use("missing.json"), 1, {"missing.json: there is no such file"});
  expect_failure(use("garbage.json"), 1, {"garbage.json: not a JSON file", "freshet query label"});
  expect_failure(use("list.json"), 1, {"list.json: an object expected"});
  expect_failure(use("other.json"), 1, {"other.json: \"format\" is missing"});

  cv::imwrite(folder_ / "other.png", cv::Mat(100, 120, CV_8UC3, cv::Scalar::all(90)));
  expect_failure(folder_.freshet({"synth", "animate", sample().store, "other.png", "--whole", "--frames",
                                  "16", "-o", "out.mkv", "--assignment", "good.json"}),
                 1, {"good.json: it was made for a picture of 192 x 144 px, and other.png has 120 x 100"});

  // A store that lacks its clips.
  ASSERT_EQ(folder_.freshet({"ingest", "river.store", sample().clips / "river"}).exit_code, 0);
  expect_failure(folder_.freshet({"synth", "animate", "river.store", sample().still, "--whole", "--frames",
                                  "16", "-o", "out.mkv", "--assignment", "good.json"}),
                 1, {"fall/", "the store does not hold it", "ingest the clip"});
  EXPECT_FALSE(fs::exists(folder_ / "out.mkv"));
}

}  // namespace
}  // namespace freshet::tools
