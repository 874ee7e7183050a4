// What comes out of a store is what went in, in the words of the ffmpeg tool.

#include <gtest/gtest.h>

#include <cstdlib>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// The lines about frames, without those of the header.
std::vector<std::string> frame_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (const std::string& line : lines_of(text))
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  return lines;
}

std::vector<std::string> ffmpegs_lines(const WorkFolder& folder, const fs::path& video) {
  const Outcome outcome =
      folder.run({"ffmpeg", "-v", "error", "-i", video, "-map", "0:v:0", "-f", "framemd5", "-"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return frame_lines(outcome.out);
}

std::vector<std::string> our_lines(const WorkFolder& folder, const std::string& store,
                                   const std::string& clip) {
  const Outcome outcome = folder.freshet({"store", "framemd5", store, clip});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return frame_lines(outcome.out);
}

bool have_ffmpeg() { return WorkFolder().run({"ffmpeg", "-version"}).exit_code == 0; }

struct Encoding {
  const char* name;
  std::vector<std::string> options;
};

TEST(ClipsOut, FramesOfEveryKindHashAsFfmpegHashesTheirSource) {
  if (!have_ffmpeg()) GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  const WorkFolder folder;
  const std::vector<Encoding> encodings{
      {"h264_420.mp4", {"-c:v", "libx264", "-pix_fmt", "yuv420p"}},
      {"grey.mkv", {"-c:v", "ffv1", "-pix_fmt", "gray"}},
      {"ten_bits.mkv", {"-c:v", "ffv1", "-pix_fmt", "yuv420p10le"}},
      {"rgb.mkv", {"-c:v", "ffv1", "-pix_fmt", "bgr0"}},
      {"odd_444.mkv", {"-vf", "crop=131:97:3:5:exact=1", "-c:v", "ffv1", "-pix_fmt", "yuv444p"}}};
  std::vector<std::string> ingest{"ingest", "a.store", "--force", "--no-index"};
  for (const Encoding& encoding : encodings) {
    std::vector<std::string> command{"ffmpeg",    "-v", "error", "-i", sample().clips / "fall/1.mkv",
                                     "-frames:v", "12"};
    command.insert(command.end(), encoding.options.begin(), encoding.options.end());
    command.emplace_back(encoding.name);
    ASSERT_EQ(folder.run(command).exit_code, 0) << encoding.name;
    ingest.emplace_back(encoding.name);
  }
  const Outcome outcome = folder.freshet(ingest);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (const Encoding& encoding : encodings) {
    const std::vector<std::string> ours = our_lines(folder, "a.store", encoding.name);
    EXPECT_EQ(ours.size(), 12U);
    EXPECT_EQ(ours, ffmpegs_lines(folder, folder / encoding.name)) << encoding.name;
    // Exported, it is still the same, in the same planes.
    const Outcome exported =
        folder.freshet({"store", "export", "a.store", encoding.name, "-o", "out.mkv", "--overwrite"});
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_EQ(exported.out, "out.mkv\n");
    EXPECT_EQ(ffmpegs_lines(folder, folder / "out.mkv"), ours) << encoding.name;
  }
}

/// When each frame of the video is shown, as ffprobe prints it.
std::string frame_times(const WorkFolder& folder, const fs::path& video) {
  const Outcome outcome = folder.run({"ffprobe", "-v", "error", "-select_streams", "v:0", "-show_entries",
                                      "packet=pts_time", "-of", "csv", video});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return outcome.out;
}

TEST(ClipsOut, AVariableFrameRateComesOutWithItsTimes) {
  if (!have_ffmpeg()) GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  const WorkFolder folder;
  ASSERT_EQ(folder
                .run({"ffmpeg", "-v", "error", "-i", sample().clips / "fall/1.mkv", "-vf",
                      "select='lt(mod(n,24),8)+not(mod(n,2))'", "-vsync", "vfr", "-c:v", "ffv1", "phone.mkv"})
                .exit_code,
            0);
  ASSERT_EQ(folder.freshet({"ingest", "a.store", "phone.mkv", "--force", "--no-index"}).exit_code, 0);
  const Outcome kept = folder.freshet({"store", "export", "a.store", "phone.mkv", "-o", "out.mkv"});
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  EXPECT_EQ(kept.err.find("varies"), std::string::npos) << kept.err;
  EXPECT_EQ(frame_times(folder, folder / "out.mkv"), frame_times(folder, folder / "phone.mkv"));
  const Outcome even = folder.freshet({"store", "export", "a.store", "phone.mkv", "-o", "out.mp4"});
  ASSERT_EQ(even.exit_code, 0) << even.err;
  EXPECT_NE(even.err.find(".mkv keeps their times"), std::string::npos) << even.err;
}

TEST(ClipsOut, APictureSequenceHasAllFrames) {
  const WorkFolder folder;
  fs::create_directories(folder / "frames");
  const Outcome outcome =
      folder.freshet({"store", "export", sample().store, "fall/1.mkv", "-o", "frames/%03d.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  int count = 0;
  for (const auto& entry : fs::directory_iterator(folder / "frames")) {
    EXPECT_EQ(cv::imread(entry.path()).size(), cv::Size(kWidth, kHeight)) << entry.path();
    ++count;
  }
  EXPECT_EQ(count, kFrames);
}

TEST(ClipsOut, AClipThatTheStoreLacksIsAnsweredWithThoseItHas) {
  const Outcome outcome = WorkFolder().freshet({"store", "framemd5", sample().store, "nosuch"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("sample.store: it holds no clip named \"nosuch\""), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("river/1.mkv"), std::string::npos) << outcome.err;
}

TEST(ClipsOut, ARealClipHashesAsFfmpegHashesIt) {
  if (!have_ffmpeg()) GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  const char* variable = std::getenv("FRESHET_FOOTAGE");
  const fs::path footage = variable ? fs::path(variable) : fs::path(FRESHET_SOURCE_DIR) / "../shared/footage";
  const fs::path clip = footage / "clips/water/fountain_jet_dyntex.avi";
  if (!fs::exists(clip))
    GTEST_SKIP() << clip << " is missing: set FRESHET_FOOTAGE to the folder of real clips";
  const WorkFolder folder;
  const Outcome outcome = folder.freshet({"ingest", "a.store", clip, "--force", "--no-index", "--scales",
                                          "0.5", "--rotations", "0", "--no-flips"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::vector<std::string> ours = our_lines(folder, "a.store", clip.filename());
  EXPECT_GT(ours.size(), 50U);
  EXPECT_EQ(ours, ffmpegs_lines(folder, clip));
}

}  // namespace
}  // namespace freshet::tools
