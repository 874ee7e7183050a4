// The fluid by itself, for a compositor, and what it lies over: read back by other programs.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

constexpr int kAnimated = 4;

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The sample's waterfall, labelled once, rendered into files of many kinds.
class Layers : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new WorkFolder;
    const Outcome outcome =
        folder_->freshet({"query", "label", sample().store, sample().still, "--matte", sample().matte,
                          "--frames", std::to_string(kAnimated), "-o", "assignment.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    // A sky of 16 bits whose steps are finer than those of 8, over which the matte's lower half moves.
    cv::Mat deep(kHeight, kWidth, CV_16UC3), matte(kHeight, kWidth, CV_8U, cv::Scalar(0));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        deep.at<cv::Vec3w>(y, x) =
            cv::Vec3w(static_cast<ushort>(30000 + 7 * x + y), static_cast<ushort>(20000 + 5 * x),
                      static_cast<ushort>(9000 + 3 * y));
    matte(cv::Rect(0, kHeight / 2, kWidth, kHeight / 2)).setTo(255);
    cv::imwrite(*folder_ / "deep.png", deep);
    cv::imwrite(*folder_ / "lower.png", matte);
    must({"oiiotool", "deep.png", "--colorconvert", "sRGB", "linear", "-d", "half", "-o", "light.exr"});
  }
  static void TearDownTestSuite() { delete folder_; }

  static Outcome animate(const std::string& out, std::vector<std::string> more = {},
                         const std::string& still = sample().still,
                         const std::string& matte = sample().matte) {
    std::vector<std::string> arguments{"synth",        "animate",
                                       sample().store, still,
                                       "--matte",      matte,
                                       "--assignment", "assignment.json",
                                       "--frames",     std::to_string(kAnimated),
                                       "-o",           out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return folder_->freshet(arguments);
  }
  static void made(const std::string& out, std::vector<std::string> more = {},
                   const std::string& still = sample().still, const std::string& matte = sample().matte) {
    const Outcome outcome = animate(out, std::move(more), still, matte);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  static std::string must(const std::vector<std::string>& command) {
    const Outcome outcome = folder_->run(command);
    EXPECT_EQ(outcome.exit_code, 0) << command[0] << ": " << outcome.err;
    return outcome.out;
  }
  static cv::Mat read(const std::string& name) {
    const cv::Mat picture = cv::imread(*folder_ / name, cv::IMREAD_UNCHANGED);
    EXPECT_FALSE(picture.empty()) << name;
    return picture;
  }
  /// Any picture as floats, by OpenImageIO.
  static cv::Mat read_by_oiio(const std::string& name) {
    must({"oiiotool", name, "-d", "float", "-o", "read.tif"});
    return read("read.tif");
  }
  static std::string probe(const std::string& name, const std::string& entries) {
    return must({"ffprobe", "-v", "error", "-select_streams", "v", "-show_entries", "stream=" + entries,
                 "-of", "default=nw=1", name});
  }
  /// colour * alpha (where straight) + (1 - alpha) * below, in units of `white`.
  static cv::Mat over(const cv::Mat& fluid, const cv::Mat& below, double white, bool straight) {
    cv::Mat out(below.size(), CV_64FC3), f, b;
    fluid.convertTo(f, CV_64F, 1 / white);
    below.convertTo(b, CV_64F, 1 / white);
    for (int y = 0; y < out.rows; ++y)
      for (int x = 0; x < out.cols; ++x) {
        const cv::Vec4d& at = f.at<cv::Vec4d>(y, x);
        for (int k = 0; k < 3; ++k)
          out.at<cv::Vec3d>(y, x)[k] =
              (straight ? at[k] * at[3] : at[k]) + (1 - at[3]) * b.at<cv::Vec3d>(y, x)[k];
      }
    return out;
  }
  static double unlike(const cv::Mat& a, const cv::Mat& b, double white) {
    cv::Mat in_units;
    b.convertTo(in_units, CV_64F, 1 / white);
    return cv::norm(a, in_units, cv::NORM_INF);
  }

  static inline WorkFolder* folder_ = nullptr;
};

TEST_F(Layers, FluidOverThePictureIsTheWholePictureWithinALevel) {
  made("w/%04d.png");
  made("s/%04d.png", {"--layer", "fluid"});
  made("p/%04d.png", {"--layer", "fluid", "--alpha", "premultiplied"});
  made("d/%04d.png", {"--layer", "fluid", "--depth", "16"});
  const cv::Mat still = cv::imread(sample().still);
  const cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE);
  for (int i = 0; i < kAnimated; ++i) {
    const std::string name = "/000" + std::to_string(i) + ".png";
    const cv::Mat whole = read("w" + name), straight = read("s" + name), premultiplied = read("p" + name),
                  deep = read("d" + name);
    ASSERT_EQ(straight.type(), CV_8UC4);
    ASSERT_EQ(deep.type(), CV_16UC4);
    EXPECT_LE(unlike(over(straight, still, 255, true), whole, 255), 1.01 / 255) << i;
    EXPECT_LE(unlike(over(premultiplied, still, 255, false), whole, 255), 1.01 / 255) << i;
    cv::Mat still_16;
    still.convertTo(still_16, CV_16U, 257);
    EXPECT_LE(unlike(over(deep, still_16, 65535, true), whole, 255), 0.51 / 255) << i;
    cv::Mat alpha;
    cv::extractChannel(straight, alpha, 3);
    cv::Mat low = matte.clone();
    low.setTo(0, matte < 8);
    EXPECT_EQ(cv::norm(alpha, low, cv::NORM_INF), 0) << "the layer's alpha is the matte";
  }
  EXPECT_TRUE(holds(must({"identify", "-format", "%z %[channels]", "d/0000.png"}), "16 srgba"));
}

TEST_F(Layers, ExrHoldsLinearLightPremultiplied) {
  made("w.%04d.exr", {"--depth", "float"});
  made("f.%04d.exr", {"--layer", "fluid", "--depth", "float"});
  made("h.%04d.exr", {"--layer", "fluid"});
  made("u.%04d.exr", {"--layer", "fluid", "--alpha", "straight", "--depth", "float"});
  const std::string header = must({"exrheader", "h.0000.exr"});
  for (const char* words : {"A, 16-bit floating-point", "R, 16-bit floating-point",
                            "displayWindow (type box2i): (0 0) - (191 143)"})
    EXPECT_TRUE(holds(header, words)) << header;
  EXPECT_TRUE(holds(must({"exrheader", "f.0000.exr"}), "A, 32-bit floating-point"));
  must({"oiiotool", sample().still, "-d", "float", "--colorconvert", "sRGB", "linear", "-o", "still.tif"});
  const cv::Mat still = read("still.tif");
  for (const char* number : {"0000", "0003"}) {
    const std::string name = std::string(".") + number + ".exr";
    const cv::Mat whole = read_by_oiio("w" + name), fluid = read_by_oiio("f" + name),
                  half = read_by_oiio("h" + name), straight = read_by_oiio("u" + name);
    EXPECT_LE(unlike(over(fluid, still, 1, false), whole, 1), 1e-4);
    EXPECT_LE(unlike(over(straight, still, 1, true), whole, 1), 1e-4);
    EXPECT_LE(cv::norm(half, fluid, cv::NORM_INF), 1e-3);
    cv::Mat alpha;
    cv::extractChannel(fluid, alpha, 3);
    EXPECT_LE(cv::norm(fluid.reshape(1), cv::NORM_INF), 1.0001);
    EXPECT_EQ(cv::countNonZero(alpha > 1), 0);
  }
}

TEST_F(Layers, ProResAndWebpHaveAlpha) {
  made("s16/%04d.png", {"--layer", "fluid", "--depth", "16"});
  made("f.mov", {"--layer", "fluid"});
  made("f.webp", {"--layer", "fluid"});
  const std::string stream = probe("f.mov",
                                   "codec_name,profile,width,height,pix_fmt,color_space,color_transfer,color_"
                                   "primaries,color_range,nb_frames");
  for (const char* words : {"codec_name=prores", "profile=4444", "width=192", "height=144",
                            "pix_fmt=yuva444p", "color_space=bt709", "color_transfer=bt709",
                            "color_primaries=bt709", "color_range=tv", "nb_frames=4"})
    EXPECT_TRUE(holds(stream, words)) << stream;
  fs::create_directories(*folder_ / "mov");
  must({"ffmpeg", "-v", "error", "-i", "f.mov", "-pix_fmt", "rgba64be", "mov/%04d.png"});
  const cv::Mat first = read("mov/0001.png"), truth = read("s16/0000.png");
  cv::Mat got, right;
  cv::extractChannel(first, got, 3);
  cv::extractChannel(truth, right, 3);
  EXPECT_LE(cv::norm(got, right, cv::NORM_INF), 65535 / 700.0) << "ten bits of alpha";
  const std::string frames = must({"identify", "f.webp"});
  EXPECT_EQ(lines_of(frames).size(), std::size_t{kAnimated}) << frames;
  EXPECT_TRUE(holds(must({"identify", "-format", "%[channels] ", "f.webp"}), "srgba"));
}

TEST_F(Layers, WhatStandsStillKeepsAllOfItsSixteenBits) {
  made("sky/%04d.png", {}, "deep.png", "lower.png");
  const cv::Mat deep = read("deep.png");
  const cv::Rect sky(0, 0, kWidth, kHeight / 2);
  for (int i = 0; i < kAnimated; ++i) {
    const cv::Mat frame = read("sky/000" + std::to_string(i) + ".png");
    ASSERT_EQ(frame.type(), CV_16UC3) << "auto keeps the picture's depth";
    EXPECT_EQ(cv::norm(frame(sky), deep(sky), cv::NORM_INF), 0);
    std::set<int> levels, expected;
    for (int x = 0; x < kWidth; ++x) {
      levels.insert(frame.at<cv::Vec3w>(10, x)[1]);
      expected.insert(deep.at<cv::Vec3w>(10, x)[1]);
    }
    EXPECT_EQ(levels.size(), expected.size());
    EXPECT_EQ(levels.size(), std::size_t{kWidth}) << "no banding";
  }
  made("sky.mkv", {}, "deep.png", "lower.png");
  EXPECT_TRUE(holds(probe("sky.mkv", "codec_name,pix_fmt"), "codec_name=ffv1\npix_fmt=gbrp16le"));
  must({"ffmpeg", "-v", "error", "-i", "sky.mkv", "-frames:v", "1", "-pix_fmt", "rgb48be", "mkv.png"});
  EXPECT_EQ(cv::norm(read("mkv.png")(sky), deep(sky), cv::NORM_INF), 0);
  made("tif/%04d.tif", {}, "deep.png", "lower.png");
  EXPECT_TRUE(holds(must({"identify", "-format", "%m %z", "tif/0000.tif"}), "TIFF 16"));
  must({"convert", "tif/0000.tif", "tif.png"});
  EXPECT_EQ(cv::norm(read("tif.png")(sky), deep(sky), cv::NORM_INF), 0);
  made("sky.mp4", {"--depth", "10"}, "deep.png", "lower.png");
  const std::string stream =
      probe("sky.mp4", "profile,pix_fmt,color_range,color_space,color_transfer,color_primaries");
  for (const char* words : {"profile=High 10", "pix_fmt=yuv420p10le", "color_range=tv", "color_space=bt709",
                            "color_transfer=bt709", "color_primaries=bt709"})
    EXPECT_TRUE(holds(stream, words)) << stream;
}

TEST_F(Layers, LinearLightGoesInAndComesOutToTheLastBit) {
  const Outcome outcome = animate("l.%04d.exr", {}, "light.exr", "lower.png");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(holds(outcome.err, "light.exr: taken as linear light, Rec. 709 (sRGB) primaries"))
      << outcome.err;
  EXPECT_TRUE(holds(outcome.err, "[3/3] rendering")) << outcome.err;
  const cv::Mat in = read_by_oiio("light.exr").clone(), out = read_by_oiio("l.0002.exr");
  const cv::Rect sky(0, 0, kWidth, kHeight / 2);
  EXPECT_EQ(cv::norm(out(sky), in(sky), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(out, in, cv::NORM_L1), 0);
}

TEST_F(Layers, MattesAndMotionAreWrittenToo) {
  made("m/%04d.png", {"--matte-out", "mattes/%04d.png", "--motion-out", "motion/%04d.flo", "--motion-out",
                      "motion/%04d.exr", "--start-number", "1001"});
  for (const char* name :
       {"m/1001.png", "m/1004.png", "mattes/1004.png", "motion/1001.flo", "motion/1004.exr"})
    EXPECT_TRUE(fs::exists(*folder_ / name)) << name;
  EXPECT_FALSE(fs::exists(*folder_ / "m/1005.png"));
  cv::Mat matte = cv::imread(sample().matte, cv::IMREAD_GRAYSCALE), first;
  matte.setTo(0, matte < 8);
  cv::extractChannel(read("mattes/1001.png"), first, 0);
  EXPECT_EQ(cv::norm(first, matte, cv::NORM_INF), 0) << "of an outline that stands still";
  EXPECT_TRUE(holds(must({"exrheader", "motion/1001.exr"}), "forward.u, 16-bit floating-point"));
  const std::string flo = text_of(*folder_ / "motion/1001.flo");
  ASSERT_EQ(flo.size(), 12U + 8U * kWidth * kHeight);
  const cv::Mat motion(kHeight, kWidth, CV_32FC2, const_cast<char*>(flo.data() + 12));
  const cv::Scalar inside = cv::mean(motion, matte == 255), outside = cv::mean(motion, matte == 0);
  EXPECT_GT(inside[1], 0.3) << "a waterfall goes down, px a frame";
  EXPECT_EQ(outside[1], 0);
  made("p.mkv", {"--motion-out", "printed/%04d.flo", "--method", "paper"});
  const std::string printed = text_of(*folder_ / "printed/0002.flo");
  ASSERT_EQ(printed.size(), flo.size());
  const cv::Mat falls(kHeight, kWidth, CV_32FC2, const_cast<char*>(printed.data() + 12));
  EXPECT_GT(cv::mean(falls, matte == 255)[1], 0.3);
}

TEST_F(Layers, TowardsAHorizonTheMotionComesToRest) {
  const std::vector<std::string> asked{"--layout", "stands", "--variation", "0", "--direction", "right"};
  const auto speeds = [&](const char* name, const std::vector<std::string>& more) {
    std::vector<std::string> words = asked;
    words.insert(words.end(), {"--motion-out", std::string(name) + "/%04d.flo"});
    words.insert(words.end(), more.begin(), more.end());
    made(std::string(name) + ".mkv", words);
    const std::string flo = text_of(*folder_ / (std::string(name) + "/0001.flo"));
    const cv::Mat motion(kHeight, kWidth, CV_32FC2, const_cast<char*>(flo.data() + 12));
    std::vector<double> by_row;
    for (int y = 0; y < kHeight; ++y) by_row.push_back(cv::norm(cv::mean(motion.row(y))));
    return by_row;
  };
  const auto plain = speeds("plain", {}), plane = speeds("plane", {"--horizon", "60"});
  EXPECT_GT(plain[64], 0.05);
  EXPECT_LT(plane[64], 0.3 * plain[64]);
  EXPECT_GT(plane[130], plain[130]);
  EXPECT_TRUE(
      holds(animate("a.mkv", {"--horizon", "sea"}).err, "--horizon sea: auto, none, a row or a line"));
  EXPECT_EQ(animate("a.mkv", {"--horizon", "0,10,0,90"}).exit_code, 2);
}

TEST_F(Layers, AStraightUpperBorderOfWaterIsItsHorizonUnlessAskedOtherwise) {
  const auto taken = [](const std::string& out, const std::string& matte, std::vector<std::string> more) {
    more.push_back("--overwrite");
    const Outcome outcome = animate(out, std::move(more), sample().still, matte);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return holds(outcome.err, fmt::format("is straight, row {0} to {0};", kHeight / 2));
  };
  EXPECT_TRUE(taken("auto.mkv", "lower.png", {"--class", "water"}));
  EXPECT_FALSE(taken("row.mkv", "lower.png", {"--class", "water", "--horizon", std::to_string(kHeight / 2)}));
  EXPECT_FALSE(taken("none.mkv", "lower.png", {"--class", "water", "--horizon", "none"}));
  EXPECT_TRUE(text_of(*folder_ / "auto.mkv") == text_of(*folder_ / "row.mkv"));
  EXPECT_FALSE(text_of(*folder_ / "auto.mkv") == text_of(*folder_ / "none.mkv"));
  EXPECT_FALSE(taken("fire.mkv", "lower.png", {"--class", "fire"}));
  EXPECT_FALSE(taken("bent.mkv", sample().matte, {"--class", "water"})) << "its border is none";
}

TEST_F(Layers, ARangeIsPartOfTheWholeAndNumberedAsIt) {
  made("all/####.png", {"--start-number", "1001"});
  made("part/####.png", {"--start-number", "1001", "--range", "1002-1003"});
  EXPECT_FALSE(fs::exists(*folder_ / "part/1001.png"));
  EXPECT_FALSE(fs::exists(*folder_ / "part/1004.png"));
  for (const char* name : {"/1002.png", "/1003.png"})
    EXPECT_EQ(cv::norm(read("all" + std::string(name)), read("part" + std::string(name)), cv::NORM_INF), 0)
        << name;
  // The rest goes beside it; what is there is kept.
  EXPECT_EQ(animate("part/####.png", {"--start-number", "1001", "--range", "1001-1002"}).exit_code, 2);
  made("part/####.png", {"--start-number", "1001", "--range", "1004-1004"});
  EXPECT_TRUE(fs::exists(*folder_ / "part/1004.png"));
  EXPECT_TRUE(holds(animate("x/####.png", {"--range", "3-9"}).err, "the frames are numbered 0 to 3"));
  EXPECT_TRUE(holds(animate("x/####.png", {"--range", "all"}).err, "it is not A-B"));
}

TEST_F(Layers, ARangeIsTheSameWhateverIsLeftOutBeforeIt) {
  const std::vector<std::vector<std::string>> kinds{{},
                                                    {"--method", "paper"},
                                                    {"--loop"},
                                                    {"--boundary", "moving", "--memory", "1"},
                                                    {"--method", "paper", "--memory", "1"}};
  for (const std::vector<std::string>& kind : kinds) {
    const auto run = [&](const std::string& to, std::vector<std::string> more) {
      std::vector<std::string> arguments{
          "synth",      "animate", sample().store, sample().still,   "--matte",     sample().matte,
          "--frames",   "28",      "-o",           to + "/%04d.png", "--matte-out", to + "-mattes/%04d.png",
          "--overwrite"};
      arguments.insert(arguments.end(), kind.begin(), kind.end());
      arguments.insert(arguments.end(), more.begin(), more.end());
      return folder_->freshet(arguments);
    };
    for (const char* name : {"whole", "whole-mattes", "some", "some-mattes"}) fs::remove_all(*folder_ / name);
    const Outcome whole = run("whole", {}), some = run("some", {"--range", "19-22"});
    ASSERT_EQ(whole.exit_code, 0) << whole.err;
    ASSERT_EQ(some.exit_code, 0) << some.err;
    const std::string said = kind.empty() ? "default" : kind.back();
    EXPECT_FALSE(fs::exists(*folder_ / "some/0018.png"));
    EXPECT_FALSE(fs::exists(*folder_ / "some-mattes/0023.png"));
    for (const char* folder : {"", "-mattes"})
      for (const char* name : {"/0019.png", "/0020.png", "/0022.png"})
        EXPECT_TRUE(text_of(*folder_ / ("whole" + std::string(folder) + name)) ==
                    text_of(*folder_ / ("some" + std::string(folder) + name)))
            << said << " " << folder << name;
  }
}

TEST_F(Layers, AnySplitOfTheFramesOverMachinesGivesTheSameFrames) {
  constexpr int kSplit = 18;
  std::mt19937_64 random(3);
  for (const std::vector<std::string>& kind :
       {std::vector<std::string>{}, {"--loop"}, {"--method", "paper"}}) {
    const auto run = [&](const std::string& to, std::vector<std::string> more) {
      more.insert(more.end(), kind.begin(), kind.end());
      more.insert(more.end(), {"--frames", std::to_string(kSplit)});
      const Outcome outcome = folder_->freshet([&] {
        std::vector<std::string> words{"synth",   "animate",      sample().store, sample().still,
                                       "--matte", sample().matte, "-o",           to + "/%04d.png"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
      }());
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    };
    for (const char* name : {"one", "many"}) fs::remove_all(*folder_ / name);
    run("one", {});
    for (int from = 0; from < kSplit;) {
      const int to = std::min(kSplit, from + 1 + static_cast<int>(random() % 7));
      run("many", {"--range", fmt::format("{}-{}", from, to - 1), "-j", std::to_string(1 + random() % 3)});
      from = to;
    }
    for (int frame = 0; frame < kSplit; ++frame) {
      const std::string name = fmt::format("/{:04}.png", frame);
      EXPECT_TRUE(text_of(*folder_ / ("one" + name)) == text_of(*folder_ / ("many" + name)))
          << name << (kind.empty() ? "" : " " + kind.back());
    }
  }
}

TEST_F(Layers, LightIsWhatAMovingFluidAdds) {
  made("lw/%04d.png", {"--boundary", "moving", "--background", sample().still});
  made("ll/%04d.png", {"--boundary", "moving", "--background", sample().still, "--layer", "light"});
  const cv::Mat whole = read("lw/0003.png"), light = read("ll/0003.png"), still = cv::imread(sample().still);
  cv::Mat expected;
  cv::subtract(whole, still, expected);  // which ends at 0
  EXPECT_LE(cv::norm(light, expected, cv::NORM_INF), 1);
  EXPECT_GT(cv::countNonZero(light.reshape(1)), 100);
}

TEST_F(Layers, PresetsChooseByPurpose) {
  made("web.mp4", {"--preset", "web"});
  made("social.mp4", {"--preset", "social"});
  made("edit.mov", {"--preset", "edit"});
  made("archive.mkv", {"--preset", "archive"});
  made("preset.gif");
  EXPECT_LT(fs::file_size(*folder_ / "web.mp4"), fs::file_size(*folder_ / "social.mp4"));
  for (const char* name : {"web.mp4", "social.mp4"}) {
    const std::string stream =
        probe(name, "codec_name,pix_fmt,color_range,color_space,color_transfer,color_primaries");
    for (const char* words : {"codec_name=h264", "pix_fmt=yuv420p\n", "color_range=tv", "color_space=bt709",
                              "color_transfer=bt709", "color_primaries=bt709"})
      EXPECT_TRUE(holds(stream, words)) << stream;
  }
  EXPECT_TRUE(holds(probe("edit.mov", "codec_name,profile"), "codec_name=prores\nprofile=4444"));
  EXPECT_TRUE(holds(probe("archive.mkv", "codec_name,pix_fmt"), "codec_name=ffv1\npix_fmt=gbrp16le"));
  EXPECT_TRUE(holds(probe("preset.gif", "codec_name,width,height"), "codec_name=gif\nwidth=192\nheight=144"));
  EXPECT_EQ(lines_of(must({"identify", "preset.gif"})).size(), std::size_t{kAnimated});
}

TEST_F(Layers, AnotherSizeIsWrittenOfTheSameFrames) {
  made("as_it_is/%04d.png");
  made("half/%04d.png", {"--width", "96", "--matte-out", "half_mattes/%04d.png"});
  cv::Mat expected;
  cv::resize(read("as_it_is/0003.png"), expected, {96, 72}, 0, 0, cv::INTER_AREA);
  EXPECT_EQ(cv::norm(read("half/0003.png"), expected, cv::NORM_INF), 0);
  EXPECT_EQ(read("half_mattes/0003.png").size(), cv::Size(96, 72));
  made("large.mov", {"--width", "300", "--layer", "fluid"});
  EXPECT_TRUE(holds(probe("large.mov", "width,height"), "width=300\nheight=225"));
  const Outcome outcome = animate("refused/%04d.png", {"--width", "96", "--motion-out", "refused/%04d.exr"});
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_TRUE(holds(outcome.err, "--width asks for another size")) << outcome.err;
}

TEST_F(Layers, AnOddSizeIsSaidBeforeTheWork) {
  const cv::Rect odd(0, 0, kWidth - 1, kHeight - 1);
  cv::imwrite(*folder_ / "odd.png", cv::Mat(cv::imread(sample().still)(odd)));
  cv::imwrite(*folder_ / "odd_matte.png", cv::Mat(cv::imread(sample().matte, cv::IMREAD_GRAYSCALE)(odd)));
  const Outcome outcome = animate("odd.mp4", {}, "odd.png", "odd_matte.png");
  EXPECT_EQ(outcome.exit_code, 1) << "the assignment is another picture's";
  EXPECT_TRUE(holds(
      outcome.err, "odd.mp4: H.264 takes even sides only: the video has 192 x 144 px, the picture 191 x 143"))
      << outcome.err;
}

TEST_F(Layers, WhatDoesNotGoTogetherIsSaidBeforeTheWork) {
  struct Case {
    std::string out;
    std::vector<std::string> more;
    const char* message;
  };
  const std::vector<Case> cases{
      {"a.mp4", {"--layer", "fluid"}, "--layer fluid: a.mp4 holds no alpha. Use .mov"},
      {"a.gif", {"--layer", "fluid"}, "a.gif holds no alpha"},
      {"a.mkv", {"--layer", "light"}, "Add --boundary moving"},
      {"a.mkv", {"--alpha", "straight"}, "--alpha: the whole picture has none. Add --layer fluid"},
      {"a.mp4", {"--depth", "16"}, "--depth 16: a.mp4 does not hold it"},
      {"a.webp", {"--depth", "10"}, "--depth 10: a.webp does not hold it"},
      {"a.mov", {"--depth", "8"}, "ProRes 4444 has 10 bits"},
      {"a/%04d.png", {"--depth", "half"}, "PNG has 8 or 16 bits. Leave --depth out, or use .exr"},
      {"a/%04d.exr", {"--depth", "16"}, "EXR has half or float"},
      {"a.mkv", {"--preset", "web"}, "--preset web: it makes .mp4 files, and a.mkv is none"},
      {"a.mkv", {"--motion-out", "m.flo"}, "--motion-out m.flo: it is no numbered sequence"}};
  for (const Case& one : cases) {
    const Outcome outcome = animate(one.out, one.more);
    EXPECT_EQ(outcome.exit_code, 2) << one.message;
    EXPECT_TRUE(holds(outcome.err, one.message)) << one.message << "\n" << outcome.err;
    EXPECT_FALSE(fs::exists(*folder_ / one.out)) << one.message;
  }
}

}  // namespace
}  // namespace freshet::tools
