// freshet synth transfer from end to end: a design and an exemplar in, an animation with transparency out.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/tools/sample.h"
#include "tests/tools/work_folder.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kDesignWidth = 48, kDesignHeight = 40, kDesignFrames = 6;

void write_flo(const fs::path& path, cv::Size size, float u, float v) {
  std::ofstream file(path, std::ios::binary);
  const std::int32_t sides[2] = {size.width, size.height};
  file.write("PIEH", 4).write(reinterpret_cast<const char*>(sides), sizeof sides);
  const float vector[2] = {u, v};
  for (int i = 0; i < size.area(); ++i) file.write(reinterpret_cast<const char*>(vector), sizeof vector);
}

// A disc that is soft at its edge.
cv::Mat disc(cv::Size size, double x, double y, double radius) {
  cv::Mat mask(size, CV_8U);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      mask.at<std::uint8_t>(row, column) =
          cv::saturate_cast<std::uint8_t>(255 * (radius - std::hypot(column - x, row - y)) / 3);
  return mask;
}

/// A disc that goes to the right by 2 px per frame, and a blotched disc as exemplar.
class TransferTool : public testing::Test {
 protected:
  TransferTool() {
    for (const char* name : {"masks", "flow", "out"}) fs::create_directories(folder_ / name);
    for (int i = 0; i < kDesignFrames; ++i) {
      const std::string number = "000" + std::to_string(i);
      cv::imwrite(folder_ / ("masks/m." + number + ".png"),
                  disc({kDesignWidth, kDesignHeight}, 18 + 2 * i, 20, 13));
      write_flo(folder_ / ("flow/f." + number + ".flo"), {kDesignWidth, kDesignHeight}, 2, 0);
    }
    cv::imwrite(folder_ / "look.png", look({32, 32}));
  }
  static cv::Mat look(cv::Size size) {
    cv::Mat picture(size, CV_8UC4);
    cv::RNG random(5);
    random.fill(picture, cv::RNG::UNIFORM, 40, 250);
    cv::insertChannel(disc(size, 0.5 * size.width, 0.5 * size.height, 0.45 * size.width), picture, 3);
    return picture;
  }
  std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"synth", "transfer",        "--alpha-sequence",
                                   "masks", "--flow-sequence", "flow"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  Outcome transfer(const std::vector<std::string>& more) const { return folder_.freshet(command(more)); }
  Outcome transfer_look(std::vector<std::string> more) const {
    more.insert(more.begin(), {"--exemplar", "look.png"});
    return transfer(more);
  }
  std::vector<cv::Mat> by_ffmpeg(const std::string& name) const {
    fs::create_directories(folder_ / ("of_" + name));
    const Outcome made = folder_.run({"ffmpeg", "-nostdin", "-v", "error", "-y", "-i", name, "-pix_fmt",
                                      "rgba", "of_" + name + "/%03d.png"});
    EXPECT_EQ(made.exit_code, 0) << made.err;
    return read_frames(folder_ / ("of_" + name), cv::IMREAD_UNCHANGED);
  }

  WorkFolder folder_;
};

TEST_F(TransferTool, AnExemplarLargerThanTheDesignIsMadeSmallerAndItIsSaid) {
  cv::imwrite(folder_ / "large.png", look({100, 100}));
  const Outcome fitted = transfer({"--exemplar", "large.png", "--json", "-o", "a.mkv"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  EXPECT_NE(fitted.err.find("of its size; --exemplar-scale 1 keeps it"), std::string::npos) << fitted.err;
  EXPECT_LT(nlohmann::json::parse(fitted.out)["exemplar"]["width"], 60);
  const Outcome kept =
      transfer({"--exemplar", "large.png", "--exemplar-scale", "1", "--json", "-o", "b.mkv"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_EQ(kept.err.find("of its size"), std::string::npos) << kept.err;
  EXPECT_EQ(nlohmann::json::parse(kept.out)["exemplar"]["width"], 100);
}

TEST_F(TransferTool, WritesTheSameAnimationToASequenceFfv1AndProRes) {
  const Outcome made = transfer_look({"-o", "out/%03d.png"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "out/%03d.png\n");
  EXPECT_NE(made.err.find("6 frames of 48 x 40"), std::string::npos) << made.err;
  EXPECT_NE(made.err.find("0 violations"), std::string::npos) << made.err;
  const std::vector<cv::Mat> frames = read_frames(folder_ / "out", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(frames.size(), std::size_t{kDesignFrames});  // and no resume folder
  for (const cv::Mat& frame : frames) {
    ASSERT_EQ(frame.type(), CV_8UC4);
    EXPECT_EQ(frame.size(), cv::Size(kDesignWidth, kDesignHeight));
  }
  // Fluid where the mask has it, nothing far from it.
  EXPECT_GT(frames[0].at<cv::Vec4b>(20, 18)[3], 200);
  EXPECT_EQ(frames[0].at<cv::Vec4b>(20, 46)[3], 0);
  EXPECT_GT(frames[5].at<cv::Vec4b>(20, 28)[3], 200);

  for (const std::string name : {"a.mkv", "a.mov"}) {
    const Outcome video = transfer_look({"-o", name});
    ASSERT_EQ(video.exit_code, 0) << video.err;
    EXPECT_FALSE(fs::exists(folder_ / (name + ".resume")));
    const std::vector<cv::Mat> seen = by_ffmpeg(name);
    ASSERT_EQ(seen.size(), frames.size());
    for (std::size_t i = 0; i < seen.size(); ++i) {
      cv::Mat ours, theirs;
      cv::extractChannel(frames[i], ours, 3);
      cv::extractChannel(seen[i], theirs, 3);
      // ProRes is within 1 of 16 bits (Alpha.ProRes*); ffmpeg's way to 8 takes up to 1 more.
      EXPECT_LE(cv::norm(ours, theirs, cv::NORM_INF), name == "a.mov" ? 2 : 0) << name;
      if (name == "a.mkv") {
        EXPECT_EQ(cv::norm(frames[i].reshape(1), seen[i].reshape(1), cv::NORM_INF), 0);
      }
    }
  }
}

TEST_F(TransferTool, ThreadsDoNotMatterAndTheSeedDoes) {
  for (const char* const threads : {"1", "3"})
    ASSERT_EQ(transfer_look({"-o", std::string("t") + threads + ".mkv", "-j", threads}).exit_code, 0);
  ASSERT_EQ(transfer_look({"-o", "s.mkv", "--seed", "2"}).exit_code, 0);
  const std::string one = text_of(folder_ / "t1.mkv");
  EXPECT_EQ(one, text_of(folder_ / "t3.mkv"));
  EXPECT_NE(one, text_of(folder_ / "s.mkv"));
}

/// Waits until so many frames have been kept.
bool has_kept(const fs::path& folder, std::size_t frames) {
  for (int i = 0; i < 12000; ++i) {
    const nlohmann::json notes = nlohmann::json::parse(text_of(folder / "frames.json"), nullptr, false);
    if (notes.is_array() && notes.size() >= frames && fs::exists(folder / "state")) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return false;
}

TEST_F(TransferTool, AStoppedRunGoesOnWhereItWas) {
  // Slow enough that a signal finds frames left to make.
  const auto slow = [this](std::vector<std::string> more) {
    more.insert(more.end(), {"--iterations", "12"});
    return transfer_look(more);
  };
  ASSERT_EQ(slow({"-o", "whole.mkv", "-j", "1"}).exit_code, 0);
  ASSERT_EQ(slow({"-o", "out/%03d.png"}).exit_code, 0);
  const std::vector<cv::Mat> whole = read_frames(folder_ / "out", cv::IMREAD_UNCHANGED);
  for (const int signal : {SIGINT, SIGKILL})
    for (const std::string out : {"part.mkv", "cut/%03d.png"}) {
      fs::create_directories(folder_ / "cut");
      const fs::path kept = folder_ / (out == "part.mkv" ? "part.mkv.resume" : "cut/frames.resume");
      std::vector<std::string> words =
          command({"--exemplar", "look.png", "-o", out, "-j", "1", "--iterations", "12"});
      words.insert(words.begin(), executable());
      const Started started = folder_.start(words);
      ASSERT_TRUE(has_kept(kept, 1));
      ::kill(started.process, signal);
      const Outcome stopped = WorkFolder::wait(started);
      EXPECT_EQ(stopped.signal, signal) << stopped.err;
      if (signal == SIGINT) {
        EXPECT_NE(stopped.err.find("of 6 frames are kept in"), std::string::npos) << stopped.err;
      }
      EXPECT_FALSE(fs::exists(folder_ / "part.mkv"));

      // Other settings would make another animation of the rest.
      const Outcome other = slow({"-o", out, "--lambda", "0.5"});
      EXPECT_EQ(other.exit_code, 2);
      EXPECT_NE(other.err.find("differs in lambda (then 0.2, now 0.5)"), std::string::npos) << other.err;
      const Outcome rest = slow({"-o", out, "-j", "2", "--json"});
      ASSERT_EQ(rest.exit_code, 0) << rest.err;
      EXPECT_NE(rest.err.find("going on"), std::string::npos) << rest.err;
      const nlohmann::json report = nlohmann::json::parse(rest.out);
      EXPECT_GE(report["resumed_frames"], 1);
      EXPECT_EQ(report["by_frame"].size(), std::size_t{kDesignFrames});
      EXPECT_FALSE(fs::exists(kept));
      if (out == "part.mkv") {
        EXPECT_EQ(text_of(folder_ / "part.mkv"), text_of(folder_ / "whole.mkv"));
        fs::remove(folder_ / "part.mkv");
      } else {
        const std::vector<cv::Mat> frames = read_frames(folder_ / "cut", cv::IMREAD_UNCHANGED);
        ASSERT_EQ(frames.size(), whole.size());
        for (std::size_t i = 0; i < frames.size(); ++i)
          EXPECT_EQ(cv::norm(frames[i].reshape(1), whole[i].reshape(1), cv::NORM_INF), 0) << i;
        fs::remove_all(folder_ / "cut");
      }
    }
}

TEST_F(TransferTool, ReportsUniformityByFrameAndTheBaselineHasNone) {
  const Outcome made = transfer_look({"-o", "a.mkv", "--json"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const nlohmann::json report = nlohmann::json::parse(made.out);
  EXPECT_EQ(report["uniform_frames"], kDesignFrames);
  EXPECT_EQ(report["violations"], 0);
  EXPECT_EQ(report["exemplar"]["opaque"], false);
  EXPECT_EQ(report["by_frame"].size(), std::size_t{kDesignFrames});
  for (const char* stage : {"prepare", "search", "assign", "vote", "write", "total"})
    EXPECT_GE(report["seconds"][stage].get<double>(), 0) << stage;
  const Outcome kwatra =
      transfer_look({"-o", "k.mkv", "--uniformity", "off", "--initialise", "random", "--json"});
  ASSERT_EQ(kwatra.exit_code, 0) << kwatra.err;
  EXPECT_LT(nlohmann::json::parse(kwatra.out)["uniform_frames"], kDesignFrames);
}

TEST_F(TransferTool, LiesOverABackground) {
  cv::imwrite(folder_ / "wall.png", cv::Mat(60, 80, CV_8UC3, cv::Scalar(200, 100, 50)));
  const Outcome made = transfer_look({"-o", "out/%03d.png", "--frames", "2", "--over", "wall.png",
                                      "--composite", "both.mkv", "--at", "20,10"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "out/%03d.png\nboth.mkv\n");
  const cv::Mat fluid = cv::imread(folder_ / "out/001.png", cv::IMREAD_UNCHANGED);
  const std::vector<cv::Mat> both = by_ffmpeg("both.mkv");
  ASSERT_EQ(both.size(), 2U);
  ASSERT_EQ(both[1].size(), cv::Size(80, 60));
  const int wall[3] = {200, 100, 50};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const bool on = cv::Rect(20, 10, kDesignWidth, kDesignHeight).contains({x, y});
      const cv::Vec4b over = on ? fluid.at<cv::Vec4b>(y - 10, x - 20) : cv::Vec4b(0, 0, 0, 0);
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(both[1].at<cv::Vec4b>(y, x)[c], (over[c] * over[3] + wall[c] * (255 - over[3])) / 255.0,
                    0.51);
    }
}

TEST_F(TransferTool, LightOnBlackJoinsItsBackgroundAsLight) {
  cv::imwrite(folder_ / "wall.png", cv::Mat(kDesignHeight, kDesignWidth, CV_8UC3, cv::Scalar(200, 100, 50)));
  cv::Mat flames(32, 32, CV_8UC3, cv::Scalar::all(0));
  for (int x = 6; x < 26; x += 5)
    flames(cv::Rect(x, 6, 2, 20)).setTo(cv::Scalar(20, 120, 250));  // filaments, dark between
  cv::imwrite(folder_ / "flames.png", flames);
  const int wall[3] = {200, 100, 50};
  for (const std::string blend : {"", "add", "screen", "over"}) {
    std::vector<std::string> words{"--exemplar", "flames.png",     "--ground",   "black",       "--frames",
                                   "2",          "--over",         "wall.png",   "--composite", "both.mkv",
                                   "-o",         "light/%03d.png", "--overwrite"};
    if (!blend.empty()) words.insert(words.end(), {"--blend", blend});
    const Outcome made = transfer(words);
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const cv::Mat light = cv::imread(folder_ / "light/001.png", cv::IMREAD_UNCHANGED);
    const std::vector<cv::Mat> both = by_ffmpeg("both.mkv");
    ASSERT_EQ(both.size(), 2U);
    int lit = 0;
    for (int y = 0; y < kDesignHeight; ++y)
      for (int x = 0; x < kDesignWidth; ++x) {
        const cv::Vec4b over = light.at<cv::Vec4b>(y, x);
        lit += over[3] > 128;
        // Alpha is the light alone.
        ASSERT_TRUE(over[3] == 0 || std::max({over[0], over[1], over[2]}) == 255);
        for (int c = 0; c < 3; ++c) {
          const double part = over[c] * over[3] / 255.0;
          const double expected = blend == "over"  ? part + wall[c] * (255 - over[3]) / 255.0
                                  : blend == "add" ? std::min(255.0, part + wall[c])
                                                   : part + wall[c] - part * wall[c] / 255.0;
          ASSERT_NEAR(both[1].at<cv::Vec4b>(y, x)[c], expected, 0.51) << blend;
        }
      }
    EXPECT_GT(lit, 50);
  }
}

TEST_F(TransferTool, TakesVideosPatternsAStoreAndAConfig) {
  ASSERT_EQ(
      folder_
          .run({"ffmpeg", "-nostdin", "-v", "error", "-i", "masks/m.%04d.png", "-c:v", "ffv1", "masks.mkv"})
          .exit_code,
      0);
  const Outcome plain = transfer_look({"-o", "plain.mkv", "--frames", "2"});
  ASSERT_EQ(plain.exit_code, 0) << plain.err;
  const Outcome patterns =
      folder_.freshet({"synth", "transfer", "--exemplar", "look.png", "--alpha-sequence", "masks/m.####.png",
                       "--flow-sequence", "flow/f.%04d.flo", "-o", "patterns.mkv", "--frames", "2"});
  ASSERT_EQ(patterns.exit_code, 0) << patterns.err;
  EXPECT_EQ(text_of(folder_ / "patterns.mkv"), text_of(folder_ / "plain.mkv"));
  const fs::path config =
      folder_.file("c.toml",
                   "[synth.transfer]\nexemplar = \"look.png\"\nalpha-sequence = \"masks.mkv\"\n"
                   "flow-sequence = \"flow\"\noutput = \"config.mkv\"\nframes = 2\n");
  const Outcome configured = folder_.freshet({"--config", config, "synth", "transfer"});
  ASSERT_EQ(configured.exit_code, 0) << configured.err;
  EXPECT_EQ(text_of(folder_ / "config.mkv"), text_of(folder_ / "plain.mkv"));

  fs::create_directories(folder_ / "design");
  fs::copy(folder_ / "masks", folder_ / "design/alpha");
  fs::copy(folder_ / "flow", folder_ / "design/flow");
  folder_.file("design/flow/f.0000.exr", "not read: there is a .flo of each frame");
  const Outcome designed = folder_.freshet({"synth", "transfer", "--exemplar", "look.png", "--design",
                                            "design", "-o", "designed.mkv", "--frames", "2"});
  ASSERT_EQ(designed.exit_code, 0) << designed.err;
  EXPECT_EQ(text_of(folder_ / "designed.mkv"), text_of(folder_ / "plain.mkv"));

  const Outcome stored = transfer({"--store", sample().store, "--exemplar", "river/1.mkv", "-o", "river.mkv",
                                   "--frames", "2", "--levels", "2", "--json"});
  ASSERT_EQ(stored.exit_code, 0) << stored.err;
  EXPECT_NE(stored.err.find("river/1.mkv: it has no transparency and is taken to be opaque"),
            std::string::npos)
      << stored.err;
  const nlohmann::json report = nlohmann::json::parse(stored.out);
  EXPECT_EQ(report["exemplar"]["opaque"], true);
  EXPECT_EQ(report["exemplar"]["frames"], kRiverFrames);
  EXPECT_EQ(report["exemplar"]["width"], kWidth);
}

TEST_F(TransferTool, BadInputIsRefusedBeforeTheWorkStarts) {
  const cv::Size size(kDesignWidth, kDesignHeight);
  const auto copy = [&](const std::string& from, const std::string& to) {
    fs::copy(folder_ / from, folder_ / to, fs::copy_options::recursive);
  };
  copy("flow", "short_flow");
  fs::remove(folder_ / "short_flow/f.0005.flo");
  copy("masks", "gap_masks");
  fs::remove(folder_ / "gap_masks/m.0003.png");
  copy("flow", "gap_flow");
  fs::remove(folder_ / "gap_flow/f.0002.flo");
  copy("flow", "nan_flow");
  write_flo(folder_ / "nan_flow/f.0004.flo", size, std::numeric_limits<float>::quiet_NaN(), 0);
  copy("flow", "far_flow");
  write_flo(folder_ / "far_flow/f.0001.flo", size, std::numeric_limits<float>::infinity(), 0);
  copy("flow", "small_flow");
  write_flo(folder_ / "small_flow/f.0003.flo", {20, 10}, 0, 0);
  copy("masks", "odd_masks");
  cv::imwrite(folder_ / "odd_masks/m.0002.png", cv::Mat(10, 20, CV_8U, cv::Scalar(255)));
  copy("masks", "black_masks");
  copy("masks", "white_masks");
  for (int i = 0; i < kDesignFrames; ++i) {
    const std::string name = "m.000" + std::to_string(i) + ".png";
    cv::imwrite(folder_ / "black_masks" / name, cv::Mat(size, CV_8U, cv::Scalar(0)));
    cv::imwrite(folder_ / "white_masks" / name, cv::Mat(size, CV_8U, cv::Scalar(255)));
  }
  copy("flow", "bad_flow");
  std::ofstream(folder_ / "bad_flow/f.0000.flo") << "PIEH?";
  cv::imwrite(folder_ / "tiny.png", look({7, 30}));
  cv::imwrite(folder_ / "clear.png", cv::Mat(32, 32, CV_8UC4, cv::Scalar(9, 9, 9, 0)));
  fs::create_directories(folder_ / "few");
  for (int i = 0; i < 3; ++i) cv::imwrite(folder_ / ("few/" + std::to_string(i) + ".png"), look({32, 32}));
  cv::imwrite(folder_ / "mask9.png", cv::Mat(9, 9, CV_8U, cv::Scalar(255)));
  cv::imwrite(folder_ / "wall.png", cv::Mat(60, 80, CV_8UC3, cv::Scalar(0)));
  fs::create_directories(folder_ / "nothing");

  struct Case {
    std::vector<std::string> arguments;
    int exit_code;
    std::string message;
  };
  const std::vector<Case> cases{
      {{"--flow-sequence", "short_flow"}, 1, "short_flow: there are 5 motion fields, and 6 masks in masks"},
      {{"--alpha-sequence", "gap_masks"}, 1, "gap_masks/m.0003.png: this one is missing"},
      {{"--flow-sequence", "gap_flow"}, 1, "gap_flow/f.0002.flo: this one is missing"},
      {{"--flow-sequence", "nan_flow"}, 1, "nan_flow/f.0004.flo: 1920 of its vectors are no numbers"},
      {{"--flow-sequence", "far_flow"}, 1, "far_flow/f.0001.flo: 1920 of its vectors"},
      {{"--flow-sequence", "small_flow"},
       1,
       "small_flow/f.0003.flo: it has 20 x 10 px, the mask masks/m.0003.png 48 x 40"},
      {{"--flow-sequence", "bad_flow"}, 1, "bad_flow/f.0000.flo"},
      {{"--flow-sequence", "nothing"}, 1, "nothing: the folder holds no motion fields"},
      {{"--flow-sequence", "flow/f.0000.flo"}, 1, "it is one file"},
      {{"--flow-sequence", "nowhere"}, 1, "nowhere: there is no such folder"},
      {{"--alpha-sequence", "odd_masks"}, 1, "odd_masks/m.0002.png: it has 20 x 10 px"},
      {{"--alpha-sequence", "black_masks"}, 1, "black_masks: the masks are black everywhere"},
      {{"--alpha-sequence", "white_masks"}, 1, "white_masks: the masks are white everywhere"},
      {{"--alpha-sequence", "nothing"}, 1, "nothing: the folder holds no pictures"},
      {{"--alpha-sequence", "none.mkv"}, 1, "none.mkv"},
      {{"--frames", "7"}, 1, "it has 6 frames, and 7 are asked for"},
      {{"--exemplar", "tiny.png"}, 1, "tiny.png: the exemplar is 7 x 30 px; two patches of 5 px need 10"},
      {{"--exemplar", "clear.png"}, 1, "clear.png: the exemplar is transparent everywhere"},
      {{"--exemplar", "few"}, 1, "few: it has 3 frames, too few for an animation of 6"},
      {{"--exemplar", "none.png"}, 1, "none.png"},
      {{"--exemplar-alpha", "mask9.png"}, 1, "mask9.png: it has 9 x 9 px, look.png 32 x 32"},
      {{"--exemplar-alpha", "few"}, 1, "few: there are 3 masks, and look.png has 1 frames"},
      {{"--store", "none.store"}, 1, "none.store"},
      {{"--store", sample().store, "--exemplar", "sea"},
       1,
       "sea: the store has no clip of this name. freshet store info"},
      {{"--patch", "4"}, 2, "patch: 4 is even"},
      {{"--lower", "0.9", "--upper", "0.2"}, 2, "lower: 0.9 is not below upper"},
      {{"--lambda", "-1"}, 2, "--lambda"},
      {{"--uniformity", "perhaps"}, 2, "--uniformity"},
      {{"-o", "look.png/%03d.png"}, 1, "look.png/%03d.png: the folder look.png cannot be made"},
      {{"-o", "look.png/a.mkv"}, 1, "look.png"},
      {{"-o", "a.mp4"}, 2, "a.mp4: the ending \".mp4\" names no format with alpha"},
      {{"-o", "out/%03d.jpg"}, 2, "names no format with alpha"},
      {{"--over", "wall.png"}, 2, "Give both --over BACKGROUND and --composite FILE"},
      {{"--composite", "c.mp4"}, 2, "Give both --over BACKGROUND and --composite FILE"},
      {{"--over", "wall.png", "--composite", "c.mp4", "--at", "80,0"},
       2,
       "lies beside the background of 80 x 60"},
      {{"--over", "wall.png", "--composite", "c.mp4", "--at", "left"}, 2, "--at left: it is not X,Y in px"},
      {{"--over", "masks/m.%04d.png", "--frames", "6", "--composite", "look.png/c.mp4"}, 1, "look.png"},
      {{"--over", "few", "--composite", "c.mp4"}, 1, "few: the background has 3 frames, the animation 6"}};
  for (const Case& one : cases) {
    // Each option once: the case's own, or what is right.
    std::vector<std::string> words{"synth", "transfer"};
    words.insert(words.end(), one.arguments.begin(), one.arguments.end());
    const auto given = [&](const std::string& name) {
      return std::find(one.arguments.begin(), one.arguments.end(), name) != one.arguments.end();
    };
    const std::vector<std::pair<std::string, std::string>> right{{"--alpha-sequence", "masks"},
                                                                 {"--flow-sequence", "flow"},
                                                                 {"--exemplar", "look.png"},
                                                                 {"-o", "a.mkv"}};
    for (const auto& [name, value] : right)
      if (!given(name)) words.insert(words.end(), {name, value});
    const Outcome outcome = folder_.freshet(words);
    EXPECT_EQ(outcome.exit_code, one.exit_code) << one.message << "\n" << outcome.err;
    EXPECT_NE(outcome.err.find(one.message), std::string::npos) << one.message << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << one.message;
    for (const char* name : {"a.mkv", "a.mkv.resume", "c.mp4"})
      EXPECT_FALSE(fs::exists(folder_ / name)) << name << ": " << one.message;
  }
}

}  // namespace
}  // namespace freshet::tools
