#include "media/video/video_writer.h"

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <malloc.h>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "media/frame/frame_md5.h"
#include "media/video/video_reader.h"
#include "tests/harness/noise.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

void write_all(const fs::path& path, const std::vector<cv::Mat>& pictures,
               const VideoWriterOptions& options = {}) {
  VideoWriter writer(path, pictures.at(0).size(), options);
  for (const cv::Mat& picture : pictures) writer.write(picture);
  writer.finish();
}

std::vector<Frame> read_all(const fs::path& path) {
  VideoReader reader(path);
  std::vector<Frame> frames;
  while (auto frame = reader.next()) frames.push_back(std::move(*frame));
  EXPECT_EQ(reader.complaint(), "");
  return frames;
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

/// A texture that goes down by three pixels a frame under a light that stays.
std::vector<cv::Mat> falling_water(cv::Size size, int frames) {
  cv::Mat texture = noise({size.width, 2 * size.height}, CV_8UC3, 3);
  cv::GaussianBlur(texture, texture, {}, 3);
  texture = 4 * (texture - 96);
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < frames; ++i) {
    cv::Mat picture = texture.rowRange(3 * (frames - i), 3 * (frames - i) + size.height).clone();
    picture.rowRange(0, size.height / 2) = cv::Scalar(90, 60, 40);
    pictures.push_back(picture);
  }
  return pictures;
}

TEST(VideoWriter, AnMp4DoesNotDependOnWhatLiesInMemory) {
  const ScratchFolder scratch;
  // No multiple of 16 macroblocks wide: there an encoder was found to read what nobody had written.
  const std::vector<cv::Mat> pictures = falling_water({960, 270}, 12);
  std::set<std::string> files;
  for (const int fill : {1, 77, 165}) {
    mallopt(M_PERTURB, fill);
    write_all(scratch / "a.mp4", pictures);
    std::ifstream file(scratch / "a.mp4", std::ios::binary);
    files.insert(std::string(std::istreambuf_iterator<char>(file), {}));
  }
  mallopt(M_PERTURB, 0);
  EXPECT_EQ(files.size(), 1u);
}

TEST(VideoWriter, MatroskaKeepsEveryBitOfBgrAndAlpha) {
  const ScratchFolder scratch;
  for (const int type : {CV_8UC3, CV_8UC4}) {
    std::vector<cv::Mat> pictures;
    for (std::uint64_t i = 0; i < 5; ++i) pictures.push_back(noise({33, 17}, type, i));
    write_all(scratch / "a.mkv", pictures, {.fps_num = 30000, .fps_den = 1001});
    EXPECT_EQ(VideoReader(scratch / "a.mkv").info().codec, "ffv1");
    const std::vector<Frame> frames = read_all(scratch / "a.mkv");
    ASSERT_EQ(frames.size(), pictures.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const Plane& plane = frames[i].planes[0];
      const cv::Mat samples(plane.height, plane.width / 4, CV_8UC4, plane.data,
                            static_cast<std::size_t>(plane.stride));
      std::vector<cv::Mat> ours, theirs;
      cv::split(samples, ours);
      cv::split(pictures[i], theirs);
      for (std::size_t c = 0; c < theirs.size(); ++c)
        EXPECT_EQ(cv::norm(ours[c], theirs[c], cv::NORM_INF), 0);
      EXPECT_NEAR(frames[i].time_s, static_cast<double>(i) * 1001 / 30000, 0.002);
    }
  }
}

TEST(VideoWriter, MatroskaKeepsNativeFramesAndTheirTags) {
  const ScratchFolder scratch;
  for (const char* format : {"yuv420p", "yuv422p10le", "yuva420p", "gray", "gray16le", "yuv444p12le",
                             "gbrp16le", "gbrap12le", "yuv411p"}) {
    PixelLayout layout;
    layout.format = format;
    layout.width = 33;
    layout.height = 17;
    const bool rgb = layout.format.find("rgb") != std::string::npos || layout.format.find("gbr") == 0;
    layout.range = rgb ? 2 : 1;
    layout.matrix = rgb ? 0 : 1;
    layout.primaries = layout.transfer = 1;
    layout.rotation = 270;
    layout.sar_num = 4;
    layout.sar_den = 3;
    const int depth = std::isdigit(format[std::string(format).size() - 3])
                          ? std::atoi(format + std::string(format).size() - 4)
                          : 8;
    std::vector<std::string> truth;
    {
      VideoWriter writer(scratch / "a.mkv", {33, 17});
      for (unsigned i = 0; i < 3; ++i) {
        Frame frame = make_frame(layout);
        std::uint32_t state = i;
        for (const Plane& plane : frame.planes)
          for (int y = 0; y < plane.height; ++y)
            for (int x = 0; x < plane.width; ++x) {
              state = state * 1664525u + 1013904223u;
              std::byte* sample = plane.data + y * plane.stride + x * plane.bytes_per_sample;
              const int bits = depth > 8 ? depth : plane.bytes_per_sample == 2 ? 16 : 8;
              const auto value = static_cast<std::uint16_t>(state >> (32 - bits));
              std::memcpy(sample, &value, static_cast<std::size_t>(plane.bytes_per_sample));
            }
        truth.push_back(frame_md5(frame));
        writer.write(frame);
      }
      writer.finish();
    }
    EXPECT_EQ(our_hashes(scratch / "a.mkv"), truth) << format;
    const PixelLayout back = VideoReader(scratch / "a.mkv").info().layout;
    EXPECT_EQ(back.format, format);
    EXPECT_EQ(back.rotation, 270) << format;
    EXPECT_EQ(back.sar_num * 3, back.sar_den * 4) << format;
    if (!rgb) {
      EXPECT_EQ(back.range, 1) << format;
      EXPECT_EQ(back.matrix, 1) << format;
      EXPECT_EQ(back.primaries, 1) << format;
      EXPECT_EQ(back.transfer, 1) << format;
    }
  }
}

TEST(VideoWriter, LayoutsThatFfv1LacksAreRepackedWithoutLoss) {
  const ScratchFolder scratch;
  for (const char* format : {"rgb24", "bgr24", "gbrp", "rgba", "argb", "nv12", "yuyv422", "p010le"}) {
    PixelLayout layout;
    layout.format = format;
    layout.width = 34;
    layout.height = 18;
    layout.range = 1;
    if (std::string(format).find("yuyv") == 0 || format[0] == 'n' || format[0] == 'p')
      layout.matrix = 1;
    else
      layout.range = 2;
    Frame frame = make_frame(layout);
    std::uint32_t state = 5;
    for (const Plane& plane : frame.planes)
      for (int y = 0; y < plane.height; ++y)
        for (int x = 0; x < plane.width; ++x) {
          state = state * 1664525u + 1013904223u;
          // 10 bits in the upper part of 16, for p010
          const auto value =
              static_cast<std::uint16_t>(plane.bytes_per_sample == 2 ? (state >> 22) << 6 : state >> 24);
          std::memcpy(plane.data + y * plane.stride + x * plane.bytes_per_sample, &value,
                      static_cast<std::size_t>(plane.bytes_per_sample));
        }
    {
      VideoWriter writer(scratch / "a.mkv", {34, 18});
      writer.write(frame);
      writer.finish();
    }
    // ffmpeg's own reordering back to the first layout is the judge.
    if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to compare with";
    EXPECT_EQ(ffmpeg_hashes(scratch / "a.mkv", "",
                            std::string("-sws_flags accurate_rnd+bitexact -pix_fmt ") + format),
              std::vector<std::string>{frame_md5(frame)})
        << format;
  }
}

// swscale's way back from bgra to gbrap is not exact, so that ffmpeg cannot judge this one.
TEST(VideoWriter, PlanarRgbWithAlphaIsRepackedWithoutLoss) {
  const ScratchFolder scratch;
  PixelLayout layout;
  layout.format = "gbrap";
  layout.width = 33;
  layout.height = 17;
  const Frame frame = make_frame(layout);
  for (const Plane& plane : frame.planes) {
    cv::Mat samples(plane.height, plane.width, CV_8U, plane.data, static_cast<std::size_t>(plane.stride));
    cv::randu(samples, 0, 256);
  }
  VideoWriter writer(scratch / "a.mkv", {33, 17});
  writer.write(frame);
  writer.finish();
  const Frame back = read_all(scratch / "a.mkv").at(0);
  ASSERT_EQ(back.layout.format, "bgra");
  constexpr std::size_t kPlane[] = {1, 0, 2, 3};  // of B, G, R, A
  for (int y = 0; y < 17; ++y)
    for (int x = 0; x < 33; ++x)
      for (int c = 0; c < 4; ++c)
        ASSERT_EQ(back.planes[0].data[y * back.planes[0].stride + 4 * x + c],
                  frame.planes[kPlane[c]].data[y * frame.planes[kPlane[c]].stride + x]);
}

TEST(VideoWriter, Mp4HasTheRightSizeRateTagsAndColours) {
  const ScratchFolder scratch;
  const std::vector<cv::Scalar> colours = {
      {0, 0, 255}, {0, 255, 0}, {255, 0, 0}, {128, 128, 128}, {255, 255, 255}};
  for (const cv::Scalar& colour : colours) {
    write_all(scratch / "a.mp4", std::vector<cv::Mat>(6, cv::Mat(48, 64, CV_8UC3, colour)),
              {.fps_num = 30, .fps_den = 1});
    VideoReader reader(scratch / "a.mp4");
    EXPECT_EQ(reader.info().codec, "h264");
    EXPECT_EQ(reader.info().layout.format, "yuv420p");
    EXPECT_EQ(reader.info().layout.width, 64);
    EXPECT_EQ(reader.info().layout.height, 48);
    EXPECT_EQ(reader.info().layout.matrix, 1);
    EXPECT_EQ(reader.info().layout.range, 1);
    EXPECT_EQ(reader.info().layout.primaries, 1);
    EXPECT_EQ(reader.info().fps_num, 30 * reader.info().fps_den);
    int frames = 0;
    for (; const auto frame = reader.next(); ++frames) {
      const cv::Vec3b seen = to_bgr(*frame).at<cv::Vec3b>(24, 32);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], colour[c], 3) << colour;
    }
    EXPECT_EQ(frames, 6);
    EXPECT_EQ(reader.complaint(), "");
  }
}

TEST(VideoWriter, Mp4StartsWithItsIndexAndPadsOddSizes) {
  const ScratchFolder scratch;
  write_all(scratch / "a.mp4", std::vector<cv::Mat>(3, cv::Mat(17, 33, CV_8UC3, cv::Scalar(40, 90, 160))));
  const std::vector<char> bytes = bytes_of(scratch / "a.mp4");
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_LT(text.find("moov"), text.find("mdat"));
  const std::vector<Frame> frames = read_all(scratch / "a.mp4");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].layout.width, 34);
  EXPECT_EQ(frames[0].layout.height, 18);
  const cv::Vec3b corner = to_bgr(frames[0]).at<cv::Vec3b>(17, 33);
  EXPECT_NEAR(corner[0], 40, 4);
  EXPECT_NEAR(corner[1], 90, 4);
  EXPECT_NEAR(corner[2], 160, 4);
}

TEST(VideoWriter, WhatStandsStillInAnMp4DoesNotPulse) {
  const ScratchFolder scratch;
  cv::Mat ground;
  cv::resize(noise({80, 60}, CV_8UC3, 1), ground, {320, 240}, 0, 0, cv::INTER_CUBIC);
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < 120; ++i) {
    pictures.push_back(ground.clone());
    cv::Mat fluid;
    cv::resize(noise({40, 15}, CV_8UC3, 100 + i), fluid, {320, 60}, 0, 0, cv::INTER_CUBIC);
    fluid.copyTo(pictures.back()(cv::Rect(0, 180, 320, 60)));
  }
  write_all(scratch / "a.mp4", pictures);
  const std::vector<Frame> frames = read_all(scratch / "a.mp4");
  ASSERT_EQ(frames.size(), pictures.size());
  const cv::Rect still(0, 0, 320, 150);
  double most = 0;
  for (std::size_t i = 1; i < frames.size(); ++i)
    most = std::max(
        most, cv::norm(to_luma(frames[i])(still), to_luma(frames[i - 1])(still), cv::NORM_L1) / still.area());
  EXPECT_LT(most, 0.4) << "levels from one frame to the next";
}

TEST(VideoWriter, SaysWhatACodecMakesOfASize) {
  EXPECT_EQ(size_notice("a.mp4", {64, 48}), "");
  EXPECT_EQ(size_notice("a.mkv", {33, 17}), "");
  EXPECT_EQ(size_notice("f%04d.png", {33, 17}), "");
  EXPECT_NE(size_notice("a.mp4", {33, 17}).find("the video has 34 x 18 px, the picture 33 x 17"),
            std::string::npos);
  EXPECT_NE(size_notice("a.mp4", {5000, 3000}).find("many players and phones"), std::string::npos);
}

TEST(VideoWriter, TenBitsOfH264KeepMoreLevelsThanEight) {
  const ScratchFolder scratch;
  cv::Mat ramp(64, 512, CV_16UC3);
  for (int x = 0; x < ramp.cols; ++x)
    ramp.col(x).setTo(cv::Scalar::all(30000 + 20 * x));  // 40 levels of 8 bits
  write_all(scratch / "a.mp4", std::vector<cv::Mat>(3, ramp), {.crf = 1, .bits = 10});
  const std::vector<Frame> frames = read_all(scratch / "a.mp4");
  ASSERT_EQ(frames[0].layout.format, "yuv420p10le");
  EXPECT_EQ(frames[0].layout.matrix, 1);
  std::set<std::uint16_t> levels;
  for (int x = 0; x < ramp.cols; ++x)
    levels.insert(reinterpret_cast<const std::uint16_t*>(frames[0].planes[0].data)[x]);
  EXPECT_GT(levels.size(), 100u);
}

TEST(VideoWriter, GifsGoRoundAndHoldStillWhatStandsStill) {
  const ScratchFolder scratch;
  std::vector<cv::Mat> pictures;
  for (int i = 0; i < 6; ++i) {
    cv::Mat picture(48, 64, CV_8UC3);
    for (int x = 0; x < 64; ++x) picture.col(x).setTo(cv::Scalar(3 * x, 128, 255 - 3 * x));
    picture(cv::Rect(4 + 5 * i, 30, 12, 12)).setTo(cv::Scalar(0, 255, 255));
    pictures.push_back(picture);
  }
  write_all(scratch / "a.gif", pictures, {.fps_num = 25});
  const std::vector<Frame> frames = read_all(scratch / "a.gif");
  ASSERT_EQ(frames.size(), pictures.size());
  EXPECT_NEAR(frames[5].time_s, 0.2, 1e-6);
  const cv::Rect still(0, 0, 64, 24);
  for (const Frame& frame : frames) {
    EXPECT_LE(cv::norm(to_bgr(frame), pictures[&frame - frames.data()], cv::NORM_L1) / (64 * 48 * 3), 8);
    EXPECT_EQ(cv::norm(to_bgr(frame)(still), to_bgr(frames[0])(still), cv::NORM_INF), 0);
  }
  EXPECT_NE(std::string(bytes_of(scratch / "a.gif").data(), 800).find("NETSCAPE2.0"), std::string::npos);
}

TEST(VideoWriter, SequencesAreNumberedFromWhereTheyAreToldTo) {
  const ScratchFolder scratch;
  write_all(scratch / "f.####.png", std::vector<cv::Mat>(2, noise({33, 17}, CV_8UC3, 1)),
            {.first_number = 1001});
  EXPECT_TRUE(fs::exists(scratch / "f.1001.png"));
  EXPECT_TRUE(fs::exists(scratch / "f.1002.png"));
  EXPECT_EQ(files_in(scratch.path()), 2u);
}

TEST(VideoWriter, SamePicturesGiveSameBytes) {
  const ScratchFolder scratch;
  std::vector<cv::Mat> pictures;
  for (std::uint64_t i = 0; i < 12; ++i) pictures.push_back(noise({64, 48}, CV_8UC3, i));
  for (const char* ending : {"mp4", "mkv", "webp", "apng", "gif"}) {
    write_all(scratch / (std::string("a.") + ending), pictures);
    write_all(scratch / (std::string("b.") + ending), pictures);
    EXPECT_EQ(bytes_of(scratch / (std::string("a.") + ending)),
              bytes_of(scratch / (std::string("b.") + ending)))
        << ending;
  }
}

TEST(VideoWriter, AnimatedPngAndSequencesAreExact) {
  const ScratchFolder scratch;
  std::vector<cv::Mat> pictures;
  for (std::uint64_t i = 0; i < 4; ++i) pictures.push_back(noise({33, 17}, CV_8UC3, i));
  for (const char* name : {"a.apng", "b.png", "f%05d.png", "t%04d.tif"}) {
    write_all(scratch / name, pictures);
    const std::vector<Frame> frames = read_all(scratch / name);
    ASSERT_EQ(frames.size(), pictures.size()) << name;
    for (std::size_t i = 0; i < frames.size(); ++i)
      EXPECT_EQ(cv::norm(to_bgr(frames[i]), pictures[i], cv::NORM_INF), 0) << name << i;
  }
  EXPECT_TRUE(fs::exists(scratch / "f00000.png"));
  EXPECT_EQ(cv::norm(cv::imread((scratch / "f00003.png").string()), pictures[3], cv::NORM_INF), 0);
  const cv::Mat clear = noise({33, 17}, CV_8UC4, 9);
  write_all(scratch / "c%02d.png", {clear});
  EXPECT_EQ(cv::norm(cv::imread((scratch / "c00.png").string(), cv::IMREAD_UNCHANGED), clear, cv::NORM_INF),
            0);
}

TEST(VideoWriter, SmallPicturesAreTakenByEveryFormat) {
  const ScratchFolder scratch;
  for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1), cv::Size(2, 2), cv::Size(3, 3)})
    for (const char* name : {"a.mp4", "a.mkv", "a.mov", "a.webp", "a.apng", "a.gif", "f%05d.png"}) {
      SCOPED_TRACE(std::string(name) + " " + std::to_string(size.width) + " x " +
                   std::to_string(size.height));
      const std::vector<cv::Mat> pictures(2, noise(size, CV_8UC3, 3));
      ASSERT_NO_THROW(write_all(scratch / name, pictures));
      if (std::string(name) == "a.webp") continue;  // which FFmpeg does not read
      const std::vector<Frame> frames = read_all(scratch / name);
      ASSERT_FALSE(frames.empty());
      if (std::string(name) != "a.mkv") continue;
      EXPECT_EQ(cv::norm(to_bgr(frames[0]), pictures[0], cv::NORM_INF), 0);
    }
}

TEST(VideoWriter, AnimatedWebpHoldsEveryFrame) {
  const ScratchFolder scratch;
  std::vector<cv::Mat> pictures;
  for (std::uint64_t i = 0; i < 4; ++i) pictures.push_back(noise({40, 30}, CV_8UC3, i));
  write_all(scratch / "a.webp", pictures);
  const std::vector<char> bytes = bytes_of(scratch / "a.webp");
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_EQ(text.substr(8, 4), "WEBP");
  std::size_t frames = 0;
  for (std::size_t at = text.find("ANMF"); at != std::string::npos; at = text.find("ANMF", at + 4)) ++frames;
  EXPECT_EQ(frames, 4u);
}

TEST(VideoWriter, DeepGreySequenceKeepsSixteenBits) {
  const ScratchFolder scratch;
  PixelLayout layout;
  layout.format = "gray16le";
  layout.width = 5;
  layout.height = 3;
  Frame frame = make_frame(layout);
  cv::Mat samples(3, 5, CV_16U, frame.planes[0].data, static_cast<std::size_t>(frame.planes[0].stride));
  cv::randu(samples, 0, 65536);
  VideoWriter writer(scratch / "g%03d.png", {5, 3});
  writer.write(frame);
  writer.finish();
  EXPECT_EQ(
      cv::norm(cv::imread((scratch / "g000.png").string(), cv::IMREAD_UNCHANGED), samples, cv::NORM_INF), 0);
}

TEST(VideoWriter, AnUnfinishedVideoLeavesNothingBehind) {
  const ScratchFolder scratch;
  for (const char* name : {"a.mp4", "a.mkv", "a.webp", "a.apng"}) {
    VideoWriter writer(scratch / name, {64, 48});
    for (int i = 0; i < 3; ++i) writer.write(noise({64, 48}, CV_8UC3, 1));
    EXPECT_FALSE(fs::exists(scratch / name));
  }
  { const VideoWriter untouched(scratch / "b.mp4", {64, 48}); }
  EXPECT_EQ(files_in(scratch.path()), 0u);
}

TEST(VideoWriter, NamesTheFileTheFaultAndTheRemedy) {
  const ScratchFolder scratch;
  const auto fault = [&](ErrorKind kind, const fs::path& path, const std::function<void()>& action) {
    const std::string text = fault_of(kind, action);
    EXPECT_EQ(text.find(path.string() + ": "), 0u) << text;
    return text;
  };
  const cv::Mat picture = noise({64, 48}, CV_8UC3, 1);
  const fs::path nowhere = scratch / "no" / "a.mp4", unknown = scratch / "a.xyz", mp4 = scratch / "a.mp4";
  EXPECT_NE(fault(ErrorKind::kIo, nowhere,
                  [&] {
                    VideoWriter(nowhere, {64, 48});
                  })
                .find("does not exist"),
            std::string::npos);
  const fs::path pattern = scratch / "no" / "%05d.png";
  EXPECT_NE(fault(ErrorKind::kIo, pattern,
                  [&] {
                    VideoWriter(pattern, {64, 48});
                  })
                .find("does not exist"),
            std::string::npos);
  EXPECT_NE(fault(ErrorKind::kUsage, unknown,
                  [&] {
                    VideoWriter(unknown, {64, 48});
                  })
                .find("Use .mp4"),
            std::string::npos);
  EXPECT_NE(fault(ErrorKind::kUsage, mp4,
                  [&] {
                    VideoWriter(mp4, {64, 48}).finish();
                  })
                .find("no frame was written"),
            std::string::npos);
  EXPECT_NE(fault(ErrorKind::kUsage, mp4,
                  [&] {
                    VideoWriter(mp4, {64, 48}).write(noise({64, 48}, CV_8UC4, 1));
                  })
                .find("no alpha"),
            std::string::npos);
  EXPECT_NE(fault(ErrorKind::kUsage, mp4,
                  [&] {
                    VideoWriter(mp4, {60, 48}).write(picture);
                  })
                .find("64 x 48"),
            std::string::npos);
  EXPECT_NE(fault(ErrorKind::kUsage, mp4,
                  [&] {
                    VideoWriter(mp4, {64, 48}, {.fps_num = 0});
                  })
                .find("rate"),
            std::string::npos);
  const fs::path webp = scratch / "a.webp";  // the format ends at 16383
  EXPECT_NE(fault(ErrorKind::kUsage, webp,
                  [&] {
                    VideoWriter(webp, {20000, 8});
                  })
                .find("16383 a side"),
            std::string::npos);
  fault(ErrorKind::kUsage, mp4, [&] { VideoWriter(mp4, {64, 48}).write(cv::Mat(48, 64, CV_16UC3)); });
  fault(ErrorKind::kUsage, mp4, [&] { VideoWriter(mp4, {64, 48}).write(cv::Mat(48, 64, CV_32FC3)); });
  EXPECT_EQ(files_in(scratch.path()), 0u);
}

TEST(VideoWriter, AFullDiskIsToldAndLeavesNothingBehind) {
  const ScratchFolder scratch;
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit tight = before;
  tight.rlim_cur = 20000;
  for (const char* name : {"a.mp4", "a.mkv", "a.webp", "a.apng", "f%05d.png"}) {
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
    const std::string fault = fault_of(ErrorKind::kIo, [&] {
      VideoWriter writer(scratch / name, {128, 128});
      for (std::uint64_t i = 0; i < 20; ++i) writer.write(noise({128, 128}, CV_8UC3, i));
      writer.finish();
    });
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_NE(fault.find("Make room on the disk"), std::string::npos) << fault;
    EXPECT_EQ(files_in(scratch.path()), 0u) << name;
  }
}

}  // namespace
}  // namespace freshet::media
