// Clips and pictures that are cut, spliced, turned over, renamed or absurd, through every door by which a file comes
// in: a right answer or a message, in bounded time and memory. And whole ones with names that no one would give.

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstring>
#include <iostream>
#include <random>

#include "tests/faults/campaign.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// Whole files of many kinds, small, that mutations begin with.
struct Seeds {
  std::vector<fs::path> clips, pictures;
};

const Seeds& seeds() {
  static const Seeds made = [] {
    Seeds all;
    const Campaign& c = campaign();
    const auto ffmpeg = [&](const std::string& name, std::vector<std::string> arguments,
                            std::vector<fs::path>& to) {
      arguments.insert(arguments.begin(), {"ffmpeg", "-v", "error", "-y", "-i", "clip1.mkv"});
      arguments.push_back(name);
      // An encoder that this machine's ffmpeg lacks makes one kind fewer.
      if (c.folder.run(arguments).exit_code == 0 && fs::exists(c.folder / name))
        to.push_back(c.folder / name);
    };
    all.clips.push_back(c.folder / "clip1.mkv");
    ffmpeg("s.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p", "-g", "5"}, all.clips);
    ffmpeg("s.ts", {"-c:v", "mpeg2video", "-g", "4"}, all.clips);
    ffmpeg("s.avi", {"-c:v", "mjpeg", "-pix_fmt", "yuvj420p"}, all.clips);
    ffmpeg("s.mov", {"-c:v", "prores_ks", "-pix_fmt", "yuv422p10le"}, all.clips);
    ffmpeg("s.webm", {"-c:v", "libvpx", "-b:v", "200k"}, all.clips);
    ffmpeg("s.gif", {}, all.clips);
    ffmpeg("s.y4m", {"-pix_fmt", "yuv420p"}, all.clips);
    ffmpeg("s.h264", {"-c:v", "libx264", "-pix_fmt", "yuv420p"}, all.clips);
    ffmpeg("s.m4v", {"-c:v", "mpeg4"}, all.clips);
    for (const char* ending : {"png", "jpg", "tif", "bmp", "webp", "exr", "pgm", "tga"})
      ffmpeg(std::string("s.") + ending,
             std::strcmp(ending, "exr") == 0
                 ? std::vector<std::string>{"-frames:v", "1", "-pix_fmt", "gbrpf32le"}
                 : std::vector<std::string>{"-frames:v", "1"},
             all.pictures);
    return all;
  }();
  return made;
}

/// One of the seeds, broken.
std::string broken(const std::vector<fs::path>& from, std::mt19937& random, std::string& ending) {
  const fs::path& seed = from[random() % from.size()];
  std::string bytes = text_of(seed);
  ending = seed.extension().string();
  const auto somewhere = [&] { return bytes.empty() ? 0 : random() % bytes.size(); };
  for (std::uint32_t i = 0; i < 1 + random() % 3 && !bytes.empty(); ++i) {
    switch (random() % 8) {
      case 0:
        bytes.resize(somewhere());
        break;
      case 1: {  // spliced with another
        const std::string other = text_of(from[random() % from.size()]);
        bytes = bytes.substr(0, somewhere()) + other.substr(random() % (other.size() + 1));
        break;
      }
      case 2:
        for (int k = 0; k < 20; ++k) bytes[somewhere()] ^= static_cast<char>(1u << random() % 8);
        break;
      case 3:  // the header, where sizes and counts stand
        for (int k = 0; k < 3; ++k)
          bytes[random() % std::min<std::size_t>(bytes.size(), 300)] =
              static_cast<char>(random() % 3 == 0 ? 255 : random());
        break;
      case 4:
        ending = from[random() % from.size()].extension().string();
        break;
      case 5: {  // a run of nothing, or of all ones
        const std::size_t at = somewhere();
        std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    std::min<std::size_t>(bytes.size() - at, 400), random() % 2 == 0 ? '\0' : '\377');
        break;
      }
      case 6: {  // a big number: 32 bits, either end first
        const std::uint32_t big = random() % 2 == 0 ? 0x7fffffffu : 1000000000u;
        const std::uint32_t turned = random() % 2 == 0 ? big : __builtin_bswap32(big);
        const std::size_t at =
            somewhere() % (random() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 400) : bytes.size());
        std::memcpy(bytes.data() + at, &turned, std::min<std::size_t>(4, bytes.size() - at));
        break;
      }
      default: {  // a part twice
        const std::size_t at = somewhere();
        bytes.insert(at, bytes.substr(somewhere(), 2000));
      }
    }
  }
  return bytes;
}

Outcome ingest(const Campaign& c, const std::string& file) {
  c.begin_with("", "m.store");
  return c.run({"ingest", "m.store", "--no-index", "--force", "--", file});
}

TEST(BrokenMedia, ClipsAreTakenOrRefused) {
  const Campaign& c = campaign();
  int taken = 0, tried = 0;
  long peak = 0;
  walk_rounds("clips", at_full_length() ? 1000 : 20, [&](std::size_t round, std::mt19937& random) {
    ++tried;
    std::string ending;
    const std::string bytes = broken(seeds().clips, random, ending);
    c.folder.file("broken" + ending, bytes);
    const Outcome outcome = ingest(c, "broken" + ending);
    const std::string wrong = judge_file(outcome);
    EXPECT_EQ(wrong, "") << ending;
    if (!wrong.empty() && std::getenv("FRESHET_KEEP") != nullptr)
      fs::copy_file(c.folder / ("broken" + ending),
                    fs::path(std::getenv("FRESHET_KEEP")) / ("clip" + std::to_string(round) + ending));
    if (outcome.exit_code == 0) {
      EXPECT_EQ(c.run({"store", "verify", "m.store"}).exit_code, 0);
      ++taken;
    }
    peak = std::max(peak, outcome.peak_kib);
    fs::remove(c.folder / ("broken" + ending));
  });
  std::cout << taken << " taken, at most " << (peak >> 10) << " MiB\n";
  EXPECT_LT(taken, tried);
}

TEST(BrokenMedia, PicturesAreTakenOrRefused) {
  const Campaign& c = campaign();
  cv::Mat still(96, 96, CV_8UC3);
  cv::randu(still, 0, 255);
  cv::imwrite((c.folder / "still.png").string(), still);
  c.begin_with("indexed.store", "q.store");
  long peak = 0;
  walk_rounds("pictures", at_full_length() ? 5000 : 20, [&](std::size_t round, std::mt19937& random) {
    std::string ending;
    const std::string bytes = broken(seeds().pictures, random, ending), name = "broken" + ending;
    c.folder.file(name, bytes);
    const std::vector<std::vector<std::string>> doors{
        {"query", "candidates", "q.store", name, "--whole"},
        {"query", "candidates", "q.store", "still.png", "--matte", name},
        {"query", "candidates", "q.store", "still.png", "--whole", "--hold", name},
        {"query", "candidates", "q.store", "still.png", "--whole", "--speed-map", name},
        {"query", "candidates", "q.store", "still.png", "--whole", "--orientation-map", name},
        {"synth", "matte", name, "--box", "10,10,50,50", "-o", "matte.png", "--overwrite"},
        {"synth", "matte", "still.png", "--scribbles", name, "-o", "matte.png", "--overwrite"}};
    const std::vector<std::string>& door = doors[random() % doors.size()];
    const Outcome outcome = c.run(door);
    const std::string wrong = judge_file(outcome);
    EXPECT_EQ(wrong, "") << ending << " to " << door[0] << " " << door[1];
    if (!wrong.empty() && std::getenv("FRESHET_KEEP") != nullptr)
      fs::copy_file(c.folder / name,
                    fs::path(std::getenv("FRESHET_KEEP")) / ("picture" + std::to_string(round) + ending));
    peak = std::max(peak, outcome.peak_kib);
    fs::remove(c.folder / name);
  });
  std::cout << "at most " << (peak >> 10) << " MiB\n";
}

TEST(BrokenMedia, AbsurdClipsAreTakenOrRefused) {
  const Campaign& c = campaign();
  seeds();  // some of the clips below are made of them
  const auto make = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"ffmpeg", "-v", "error", "-y"});
    return c.folder.run(arguments).exit_code == 0;
  };
  const std::string rate = ":rate=25:duration=1";
  std::vector<std::string> files;
  const auto add = [&](const std::string& name, const std::vector<std::string>& arguments) {
    std::vector<std::string> all = arguments;
    all.push_back(name);
    if (make(all)) files.push_back(name);
  };
  add("one.mkv", {"-i", "clip1.mkv", "-vf", "scale=1:1", "-pix_fmt", "gray", "-c:v", "ffv1"});
  add("black.mkv", {"-f", "lavfi", "-i", "color=black:size=96x96" + rate, "-c:v", "ffv1"});
  add("huge.mkv", {"-f", "lavfi", "-i", "color=gray:size=16384x16000:rate=25", "-frames:v", "1", "-c:v",
                   "ffv1", "-pix_fmt", "gray"});
  add("long.mkv", {"-f", "lavfi", "-i", "color=gray:size=16384x16" + rate, "-c:v", "ffv1"});
  add("sound.mp4", {"-f", "lavfi", "-i", "sine=duration=1", "-c:a", "aac"});
  add("frame.mkv", {"-i", "clip1.mkv", "-frames:v", "1", "-c:v", "ffv1"});
  add("same.mkv", {"-loop", "1", "-i", "s.png", "-t", "1", "-c:v", "ffv1"});
  add("slow.mkv", {"-i", "clip1.mkv", "-vf", "setpts=PTS*100000", "-vsync", "vfr", "-c:v", "ffv1"});
  add("fast.mkv", {"-i", "clip1.mkv", "-vf", "settb=1/1000000,setpts=N", "-vsync", "vfr", "-c:v", "ffv1"});
  add("small.h264", {"-i", "clip1.mkv", "-vf", "scale=64:64", "-pix_fmt", "yuv420p", "-c:v", "libx264"});
  if (fs::exists(c.folder / "small.h264") && fs::exists(c.folder / "s.h264")) {  // another size in mid-stream
    c.folder.file("changes.h264", text_of(c.folder / "s.h264") + text_of(c.folder / "small.h264"));
    files.emplace_back("changes.h264");
  }
  c.folder.file("claims.y4m", "YUV4MPEG2 W1000000000 H1000000000 F25:1 C420\nFRAME\n");
  c.folder.file("zero.y4m", "YUV4MPEG2 W96 H96 F0:0 C420\nFRAME\n" + std::string(96 * 96 * 3 / 2, 'x'));
  c.folder.file("empty.mp4", "");
  for (const char* name : {"claims.y4m", "zero.y4m", "empty.mp4"}) files.emplace_back(name);
  EXPECT_GE(files.size(), 13u);
  for (const std::string& name : files) {
    const Outcome outcome = ingest(c, name);
    EXPECT_EQ(judge_file(outcome), "") << name;
    std::cout << name << ": " << outcome.exit_code << ", " << (outcome.peak_kib >> 10) << " MiB\n";
  }
}

/// Bytes that would move a cursor, ring, or colour what follows; lines are meant.
bool controls_a_terminal(const std::string& text) {
  return std::ranges::any_of(
      text, [](char c) { return (static_cast<unsigned char>(c) < 32 && c != '\n') || c == 127; });
}

TEST(BrokenMedia, NamesAreNothingButNames) {
  const Campaign& c = campaign();
  const std::vector<std::string> names{"two words.mkv",
                                       "quote\"s'.mkv",
                                       "new\nline.mkv",
                                       "not\xff\xfeutf8.mkv",
                                       "\x1b[31mred\x1b]0;title\a.mkv",
                                       "--overwrite.mkv",
                                       "-j.mkv",
                                       "<img src=x onerror=alert(1)>.mkv",
                                       "%s%n%05d.mkv",
                                       "$(touch made).mkv",
                                       std::string(200, 'n') + ".mkv",
                                       "\u202egnp.mkv",
                                       "a:b.mkv",
                                       "..mkv",
                                       "\u6d77.mkv"};
  fs::remove_all(c.folder / "names");
  fs::create_directory(c.folder / "names");
  int number = 0;
  for (const std::string& name : names) {
    std::string bytes = text_of(c.folder / "clip1.mkv");
    bytes += std::string(1, static_cast<char>(++number));  // another source each
    c.folder.file("names/" + name, bytes);
  }
  fs::create_directory_symlink("..", c.folder / "names/loop");
  fs::create_symlink("itself.mkv", c.folder / "names/itself.mkv");
  c.begin_with("", "m.store");
  const Outcome outcome = c.run({"ingest", "m.store", "--force", "names"});
  EXPECT_EQ(judge_file(outcome), "");
  EXPECT_FALSE(controls_a_terminal(outcome.out + outcome.err)) << outcome.out << outcome.err;
  const Outcome info = c.run({"store", "info", "m.store"}),
                json = c.run({"store", "info", "m.store", "--json"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_FALSE(controls_a_terminal(info.out + info.err + json.out));
  EXPECT_EQ(json.exit_code, 0) << json.err;
  EXPECT_GE(c.clips_in("m.store"), names.size() - 2) << outcome.err;  // hidden ones are passed over
  EXPECT_FALSE(fs::exists(c.folder / "made"));
  // As an output's and a store's name.
  for (const std::string& name : names) {
    if (name.size() > 200) continue;
    const Outcome made = c.run({"ingest", "--force", "--no-index", "--", name + ".store", "clip1.mkv"});
    EXPECT_EQ(judge_file(made), "") << name;
    EXPECT_EQ(c.run({"store", "verify", "--", name + ".store"}).exit_code, 0) << name;
    EXPECT_FALSE(controls_a_terminal(made.err)) << name;
    for (const char* ending : {".store", ".store-lock"}) fs::remove(c.folder / (name + ending));
  }
  const Outcome too_long = c.run({"ingest", std::string(255, 'n'), "clip1.mkv"});
  EXPECT_EQ(judge_file(too_long), "");
}

TEST(BrokenMedia, AnAnswerThatIsPlantedIsSeen) {
  const Campaign& c = campaign();
  EXPECT_NE(judge_file(c.folder.run({"sh", "-c", "kill -SEGV $$"})), "");
  EXPECT_NE(judge_file(c.folder.run({"sh", "-c", "exit 1"})), "");
  EXPECT_NE(judge_file({.exit_code = 0, .signal = 0, .out = "", .err = "", .peak_kib = kMaxFileKib + 1}), "");
  EXPECT_EQ(judge_file(c.folder.run({"sh", "-c", "echo freshet: no >&2; exit 1"})), "");
  EXPECT_TRUE(controls_a_terminal("\x1b[31m"));
}

}  // namespace
}  // namespace freshet::tools
