// Broken input: whatever the bytes, frames or a freshet::Error, and in bounded time.
#include <sys/resource.h>
#include <unistd.h>

#include <climits>
#include <fstream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

extern "C" {
#include <libavutil/mem.h>
}

#include "media/frame/decoder.h"
#include "media/frame/frame_md5.h"
#include "media/picture/picture.h"
#include "media/video/video_reader.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSource = "-f lavfi -i testsrc=s=48x32:r=10:d=2,noise=alls=20:allf=t ";

// Hashes of what decodes, then the complaint; or the error.
std::vector<std::string> outcome(const fs::path& file, int threads) {
  std::vector<std::string> digests;
  try {
    VideoReader reader(file, threads);
    while (const auto frame = reader.next()) {
      digests.push_back(frame_md5(*frame));
      to_bgr(*frame);
      if (digests.size() > 1000) break;
    }
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    EXPECT_NE(std::string(error.what()).find(file.filename().string()), std::string::npos) << error.what();
    digests.emplace_back("error");
  }
  return digests;
}

// Of the address space of this process.
std::size_t mapped_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

std::vector<char> mutant(std::vector<char> bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  const std::size_t flips = 1 + below(12);
  // Half of them in the header, where the sizes are.
  const std::size_t reach = random() % 2 ? bytes.size() : std::min<std::size_t>(bytes.size(), 700);
  for (std::size_t i = 0; i < flips; ++i) bytes[below(reach)] = static_cast<char>(random());
  if (random() % 4 == 0) bytes.resize(1 + below(bytes.size()));
  return bytes;
}

struct Victim {
  std::string file, options;
  int mutants;
};
void PrintTo(const Victim& v, std::ostream* out) { *out << v.file; }

class Damaged : public testing::TestWithParam<Victim> {};

TEST_P(Damaged, MutantsGiveFramesOrAnErrorAndNeverACrash) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: no clip to damage";
  const ScratchFolder scratch;
  const fs::path whole = scratch / GetParam().file;
  make_clip(kSource + GetParam().options, whole);
  const std::vector<char> bytes = bytes_of(whole);
  ASSERT_GT(bytes.size(), 100u);
  const std::vector<std::string> truth = outcome(whole, 1);
  std::mt19937 random(7);
  int changed = 0;
  for (int i = 0; i < GetParam().mutants; ++i) {
    const fs::path file = scratch / ("mutant" + whole.extension().string());
    put_bytes(file, mutant(bytes, random));
    changed += outcome(file, 2) != truth;
  }
  EXPECT_GT(changed, GetParam().mutants / 4);  // else the mutants were too tame to prove anything
}

INSTANTIATE_TEST_SUITE_P(
    Video, Damaged,
    testing::Values(Victim{"a.mp4", "-c:v libx264 -bf 2 -pix_fmt yuv420p -movflags faststart", 100},
                    Victim{"b.mkv", "-c:v ffv1 -level 3 -pix_fmt yuv420p", 60},
                    Victim{"c.webm", "-c:v libvpx -auto-alt-ref 0 -pix_fmt yuva420p", 60},
                    Victim{"d.avi", "-c:v mpeg4 -bf 2", 60}, Victim{"e.gif", "", 60},
                    Victim{"f.apng", "-plays 0", 60}, Victim{"g.avi", "-c:v mjpeg", 60},
                    Victim{"h.mov", "-c:v qtrle", 40}, Victim{"i.ts", "-c:v mpeg2video -r 25", 40},
                    Victim{"j.nut", "-c:v rawvideo -pix_fmt pal8", 40}),
    [](const auto& v) { return v.param.file.substr(0, 1) + "_" + v.param.file.substr(2); });

TEST(Damaged, ATruncatedFileGivesItsFirstFramesAndSaysHowMany) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: no clip to cut";
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-c:v libx264 -g 5 -pix_fmt yuv420p -movflags faststart",
            scratch / "a.mp4");
  const std::vector<std::string> truth = our_hashes(scratch / "a.mp4");
  std::vector<char> bytes = bytes_of(scratch / "a.mp4");
  bytes.resize(bytes.size() * 8 / 10);
  put_bytes(scratch / "cut.mp4", bytes);
  VideoReader reader(scratch / "cut.mp4");
  EXPECT_EQ(reader.info().claimed_frames, 20);
  std::vector<std::string> hashes;
  while (const auto frame = reader.next()) hashes.push_back(frame_md5(*frame));
  ASSERT_GE(hashes.size(), 6u);
  ASSERT_LT(hashes.size(), 20u);
  for (std::size_t i = 0; i + 2 < hashes.size(); ++i) EXPECT_EQ(hashes[i], truth[i]) << i;
  EXPECT_EQ(reader.complaint().find("file is truncated or damaged: " + std::to_string(hashes.size()) +
                                    " of 20 frames"),
            0u)
      << reader.complaint();
  EXPECT_FALSE(reader.next());
}

TEST(Damaged, DamageDecodesAlikeForAnyNumberOfThreads) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: no clip to damage";
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-c:v libx264 -bf 2 -g 8 -pix_fmt yuv420p", scratch / "a.mp4");
  const std::vector<char> bytes = bytes_of(scratch / "a.mp4");
  std::mt19937 random(3);
  int damaged = 0;
  for (int i = 0; i < 20; ++i) {
    std::vector<char> bad = bytes;
    for (int k = 0; k < 5; ++k)
      bad[64 + random() % (bytes.size() * 8 / 10)] ^= static_cast<char>(1 << random() % 8);
    put_bytes(scratch / "bad.mp4", bad);
    const auto one = outcome(scratch / "bad.mp4", 1);
    EXPECT_EQ(outcome(scratch / "bad.mp4", 2), one) << i;
    EXPECT_EQ(outcome(scratch / "bad.mp4", 5), one) << i;
    damaged += one != outcome(scratch / "a.mp4", 1);
  }
  EXPECT_GT(damaged, 5);
}

TEST(Damaged, WhatThereIsNoMemoryForIsNoDamage) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: no clip to decode";
  const ScratchFolder scratch;
  // Longer than what is read ahead to know its rate.
  make_clip("-f lavfi -i testsrc=s=48x32:r=10:d=20,noise=alls=20:allf=t -c:v mpeg4", scratch / "a.mp4");
  const auto without_memory = [](const std::function<void()>& action) {
    av_max_alloc(700);  // for each block: less than a packet or a frame
    const std::string fault = fault_of(ErrorKind::kInput, action);
    av_max_alloc(INT_MAX);
    return fault;
  };
  Decoder decoder(scratch / "a.mp4", {.threads = 1});
  EXPECT_NE(without_memory([&] {
              while (decoder.next()) {
              }
            }).find("a.mp4: there was not the memory"),
            std::string::npos);
  Decoder stamps(scratch / "a.mp4", {.threads = 1});
  EXPECT_NE(without_memory([&] { stamps.packet_stamps(); }).find("a.mp4: there was not the memory"),
            std::string::npos);
}

// Some of FFmpeg's readers pass over such a packet by themselves, that of Matroska for one.
TEST(Damaged, APacketThatThereIsNoMemoryForIsNotPassedOver) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer ends the program where there is no memory";
#endif
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: no clip to decode";
  const ScratchFolder scratch;
  for (const char* name : {"a.mkv", "a.avi"}) {
    make_clip("-f lavfi -i testsrc=s=2560x1440:r=10:d=0.5 -c:v rawvideo -pix_fmt yuv420p", scratch / name);
    rlimit given{};
    getrlimit(RLIMIT_AS, &given);

    const rlimit little{.rlim_cur = mapped_bytes() + (3u << 20), .rlim_max = given.rlim_max};
    setrlimit(RLIMIT_AS, &little);
    const std::string fault =
        fault_of(ErrorKind::kInput, [&] { Decoder(scratch / name, {.threads = 1}).packet_stamps(); });
    setrlimit(RLIMIT_AS, &given);
    EXPECT_NE(fault.find("there was not the memory"), std::string::npos) << name << ": " << fault;
  }
}

TEST(Damaged, PicturesGiveAPictureOrAnError) {
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: no picture to damage";
  const ScratchFolder scratch;
  std::mt19937 random(11);
  for (const char* name : {"a.png", "a.jpg", "a.tif", "a.bmp", "a.webp"}) {
    make_clip("-f lavfi -i testsrc=s=48x32 -frames:v 1", scratch / name);
    const std::vector<char> bytes = bytes_of(scratch / name);
    for (int i = 0; i < 60; ++i) {
      const fs::path file = scratch / (std::string("mutant") + fs::path(name).extension().string());
      put_bytes(file, mutant(bytes, random));
      try {
        EXPECT_FALSE(read_picture(file).bgr.empty());
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::kInput);
      }
    }
  }
}

}  // namespace
}  // namespace freshet::media
