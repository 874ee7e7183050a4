// Every command that writes frames takes every ending of the table, and writes what the table says.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <functional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "media/frame/bgra.h"
#include "media/frame/file_format.h"
#include "media/picture/exr_picture.h"
#include "media/picture/motion_file.h"
#include "media/picture/picture_sequence.h"
#include "media/video/video_reader.h"
#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;
using media::Coding;
using media::Depth;
using media::FileFormat;

/// What a file turned out to hold.
struct Found {
  std::size_t frames = 0;
  int bits = 0;  // 0: linear light
  bool alpha = false;
};

std::size_t count_of(const std::string& part, const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// FFmpeg 5.1 reads no animated WebP.
Found read_webp(const std::string& bytes) {
  constexpr std::size_t kFlags = 20;
  constexpr int kAlpha = 0x10;
  return {.frames = count_of("ANMF", bytes), .bits = 8, .alpha = (bytes.at(kFlags) & kAlpha) != 0};
}

Found read_film(const fs::path& file) {
  if (file.extension() == ".webp") return read_webp(text_of(file));
  media::VideoReader reader(file);
  const std::string format = reader.info().layout.format;
  Found found{.frames = 0,
              .bits = format.find("16") != std::string::npos ? 16
                      : format.find("10le") != std::string::npos || format.find("12le") != std::string::npos
                          ? 10
                          : 8,
              .alpha = media::has_alpha(reader.info().layout)};
  while (reader.next()) ++found.frames;
  return found;
}

Found read_sequence(const fs::path& pattern) {
  const media::PictureSequence files = media::find_pattern(pattern);
  Found found{.frames = files.files.size()};
  if (files.files.empty()) return found;
  const std::string bytes = text_of(files.files.front());
  if (pattern.extension() == ".exr") {
    const media::ExrPicture picture = media::decode_exr_picture({bytes.begin(), bytes.end()}, pattern);
    found.alpha = !picture.alpha.empty();
    return found;
  }
  const cv::Mat picture = cv::imread(files.files.front().string(), cv::IMREAD_UNCHANGED);
  found.bits = picture.depth() == CV_16U ? 16 : 8;
  found.alpha = picture.channels() == 4;
  return found;
}

/// Bits that a command should leave in a format. deep   whether what it writes has more than 8.
int bits_in(const FileFormat& format, bool deep) {
  if (format.depths.has(Depth::kHalf)) return 0;
  if (deep && format.depths.has(Depth::k16)) return 16;
  return format.depths.has(Depth::k8) ? 8 : 10;
}

/// A command that writes frames.
struct Command {
  const char* name;
  bool deep, alpha;
  std::function<std::vector<std::string>(const std::string& out)> words;
  std::string prefix = {};  // of the file that comes of an output
};

void walk(const WorkFolder& folder, const Command& command, std::size_t frames) {
  int number = 0;
  for (const FileFormat& format : media::file_formats()) {
    if (format.coding == Coding::kNone) continue;
    const bool film = format.kind == media::FormatKind::kFilm;
    const std::string out =
        "o" + std::to_string(++number) + (film ? "" : "/%03d") + std::string(format.ending);
    SCOPED_TRACE(std::string(command.name) + " " + out);
    const Outcome outcome = folder.freshet(command.words(out));
    if (command.alpha && !format.alpha) {
      EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
      EXPECT_NE(outcome.err.find("alpha"), std::string::npos) << outcome.err;
      continue;
    }
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const fs::path file = folder / (command.prefix + out);
    const Found found = film ? read_film(file) : read_sequence(file);
    // GIF and WebP join frames that are alike.
    EXPECT_TRUE(found.frames == frames || (found.frames < frames && found.frames > 0 && film))
        << found.frames;
    EXPECT_EQ(found.bits, bits_in(format, command.deep));
    // FFmpeg gives alpha to every GIF, and to WebP where a frame is larger than what changed in it.
    if (command.alpha || (format.coding != Coding::kGif && format.coding != Coding::kWebp)) {
      EXPECT_EQ(found.alpha, command.alpha);
    }
  }
}

/// A picture of 16 bits.
cv::Mat deep_picture(cv::Size size) {
  cv::Mat picture(size, CV_16UC3);
  cv::RNG(3).fill(picture, cv::RNG::UNIFORM, 6000, 60000);
  cv::GaussianBlur(picture, picture, {}, 1.5);
  return picture;
}

TEST(Formats, Simulate) {
  const WorkFolder folder;
  walk(folder,
       {"simulate", false, false,
        [](const std::string& out) {
          return std::vector<std::string>{"synth",    "simulate", "river", "--size", "48x32",
                                          "--frames", "3",        "-o",    out};
        }},
       3);
}

TEST(Formats, Export) {
  const WorkFolder folder;
  walk(folder,
       {"export", false, false,
        [](const std::string& out) {
          return std::vector<std::string>{"store", "export", sample().store, "fall/1.mkv", "-o", out};
        }},
       kFrames);
}

TEST(Formats, Stills) {
  const WorkFolder folder;
  fs::create_directory(folder / "stills");
  for (int i = 0; i < 3; ++i) {
    cv::Mat still = deep_picture({96, 64});
    cv::circle(still, {24 + 24 * i, 32}, 12, cv::Scalar::all(64000), cv::FILLED, cv::LINE_AA);
    cv::imwrite(folder / ("stills/" + std::to_string(i) + ".png"), still);
  }
  walk(folder,
       {"stills", true, false,
        [](const std::string& out) {
          return std::vector<std::string>{"synth", "stills", "stills", "--seconds",    "0.5",      "--fps",
                                          "6",     "-o",     out,      "--one-region", "--camera", "tripod"};
        }},
       3);
}

/// The picture of 16 bits, and what moves in it.
void make_scene(const WorkFolder& folder) {
  cv::imwrite(folder / "still.png", deep_picture({64, 48}));
  cv::Mat matte(48, 64, CV_8U, cv::Scalar(0));
  cv::circle(matte, {32, 20}, 14, 255, cv::FILLED);
  cv::imwrite(folder / "tree.png", matte);
  folder.file("scene.toml",
              "picture = \"still.png\"\nframes = 3\n[[layer]]\nname = \"tree\"\nmatte = \"tree.png\"\n"
              "motion = \"tree\"\narmature = [32, 40, 32, 8]\nmass = 1\n");
}

TEST(Formats, Scene) {
  const WorkFolder folder;
  make_scene(folder);
  walk(folder,
       {"scene", true, false,
        [](const std::string& out) {
          return std::vector<std::string>{"synth", "scene", "scene.toml", "-o", out};
        }},
       3);
}

TEST(Formats, SceneLayers) {
  const WorkFolder folder;
  make_scene(folder);
  int number = 0;
  walk(
      folder,
      {"scene --layers-out", true, true,
       [&](const std::string& out) {
         return std::vector<std::string>{
             "synth",        "scene",         "scene.toml", "-o", "whole" + std::to_string(++number) + ".mkv",
             "--layers-out", "{layer}-" + out};
       },
       "tree-"},
      3);
}

TEST(Formats, Transfer) {
  const WorkFolder folder;
  cv::Mat matte(32, 48, CV_8U, cv::Scalar(0)), look;
  cv::circle(matte, {24, 16}, 11, 255, cv::FILLED);
  const cv::Mat flow(32, 48, CV_32FC2, cv::Scalar(0, 0));
  for (const char* made : {"masks", "flow"}) fs::create_directory(folder / made);
  for (int i = 0; i < 3; ++i) {
    cv::imwrite(folder / ("masks/" + std::to_string(i) + ".png"), matte);
    media::write_motion(folder / ("flow/" + std::to_string(i) + ".flo"), flow);
  }
  cv::Mat colour(32, 48, CV_8UC3);
  cv::RNG(5).fill(colour, cv::RNG::UNIFORM, 40, 250);
  cv::cvtColor(colour, look, cv::COLOR_BGR2BGRA);
  cv::insertChannel(matte, look, 3);
  cv::imwrite(folder / "look.png", look);
  walk(folder,
       {"transfer", false, true,
        [](const std::string& out) {
          return std::vector<std::string>{
              "synth", "transfer",   "--alpha-sequence", "masks", "--flow-sequence",
              "flow",  "--exemplar", "look.png",         "-o",    out};
        }},
       3);
}

TEST(Formats, Flowlines) {
  const WorkFolder folder;
  fs::create_directory(folder / "clip");
  cv::Mat bank = deep_picture({96, 64}), water = deep_picture({32, 64 + 2 * 24});
  bank.convertTo(bank, CV_8U, 1.0 / 257);
  water.convertTo(water, CV_8U, 1.0 / 257);
  for (int i = 0; i < 24; ++i) {
    cv::Mat frame = bank.clone();
    water(cv::Rect(0, 2 * (24 - i), 32, 64)).copyTo(frame(cv::Rect(32, 0, 32, 64)));
    cv::imwrite(folder / ("clip/" + std::to_string(100 + i) + ".png"), frame);
  }
  folder.file("lines.svg",
              "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"96\" height=\"64\">"
              "<path id=\"a\" d=\"M48,4 V60\"/></svg>");
  walk(folder,
       {"flowlines", false, false,
        [](const std::string& out) {
          return std::vector<std::string>{"synth",    "flowlines", "clip", "--lines", "lines.svg",
                                          "--frames", "3",         "-o",   out};
        }},
       3);
}

TEST(Formats, Tour) {
  const WorkFolder folder;
  cv::imwrite(folder / "still.png", deep_picture({64, 48}));
  walk(folder,
       {"tour", true, false,
        [](const std::string& out) {
          return std::vector<std::string>{"synth",    "tour", "still.png", "--horizon", "20",
                                          "--frames", "3",    "-o",        out};
        }},
       3);
}

/// The still in 16 bits, and what is labelled for it.
void make_still(const WorkFolder& folder) {
  cv::Mat still = cv::imread(sample().still.string());
  still.convertTo(still, CV_16U, 257);
  cv::imwrite(folder / "still.png", still);
  const Outcome labelled = folder.freshet({"query", "label", sample().store, "still.png", "--matte",
                                           sample().matte, "--frames", "8", "-o", "assignment.json"});
  ASSERT_EQ(labelled.exit_code, 0) << labelled.err;
}

std::vector<std::string> animate(const std::string& out, const std::string& layer) {
  return {"synth",        "animate",
          sample().store, "still.png",
          "--matte",      sample().matte,
          "--assignment", "assignment.json",
          "--frames",     "8",
          "--range",      "0-2",
          "--layer",      layer,
          "-o",           out};
}

TEST(Formats, Animate) {
  const WorkFolder folder;
  make_still(folder);
  walk(folder, {"animate", true, false, [](const std::string& out) { return animate(out, "whole"); }}, 3);
}

TEST(Formats, AnimateTheFluidAlone) {
  const WorkFolder folder;
  make_still(folder);
  walk(folder, {"animate", true, true, [](const std::string& out) { return animate(out, "fluid"); }}, 3);
}

TEST(Formats, NoPipeIsReplacedByAFile) {
  const WorkFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe.mkv").c_str(), 0600), 0);
  for (const bool overwrite : {false, true}) {
    std::vector<std::string> words{"synth",    "simulate", "river", "--size",  "48x32",
                                   "--frames", "2",        "-o",    "pipe.mkv"};
    if (overwrite) words.emplace_back("--overwrite");
    const Outcome outcome = folder.freshet(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("pipe.mkv: it is a pipe or a device"), std::string::npos) << outcome.err;
    EXPECT_TRUE(fs::is_fifo(folder / "pipe.mkv"));
  }
}

TEST(Formats, EveryCommandSaysThatAnMp4OfOddSidesIsLarger) {
  const WorkFolder folder;
  const auto says = [&](const std::vector<std::string>& words, const std::string& size) {
    const Outcome outcome = folder.freshet(words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("H.264 takes even sides only: the video has " + size), std::string::npos)
        << outcome.err;
  };
  says({"synth", "simulate", "river", "--size", "49x33", "--frames", "2", "-o", "a.mp4", "--alpha", "b.mkv"},
       "50 x 34");
  says({"synth", "simulate", "river", "--size", "49x33", "--frames", "2", "-o", "a.mkv", "--alpha", "b.mp4",
        "--overwrite"},
       "50 x 34");
  fs::create_directory(folder / "stills");
  for (int i = 0; i < 3; ++i) {
    cv::Mat still(65, 97, CV_8UC3, cv::Scalar::all(60));
    cv::circle(still, {24 + 24 * i, 32}, 12, cv::Scalar::all(250), cv::FILLED, cv::LINE_AA);
    cv::imwrite(folder / ("stills/" + std::to_string(i) + ".png"), still);
  }
  says({"synth", "stills", "stills", "--seconds", "0.5", "--fps", "6", "-o", "c.mp4", "--camera", "tripod"},
       "98 x 66");
}

}  // namespace
}  // namespace freshet::tools
