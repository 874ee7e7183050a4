#include "media/video/video_reader.h"

#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "media/frame/frame_md5.h"
#include "tests/harness/scratch_folder.h"
#include "tests/media/generated_clip.h"

namespace freshet::media {
namespace {

namespace fs = std::filesystem;

#define NEEDS_FFMPEG() \
  if (!have_ffmpeg()) GTEST_SKIP() << "the ffmpeg program is missing: nothing to compare with"

struct Case {
  std::string name, file, options;  // of the encoder, after the picture source
  std::string pixel_format;         // ours
  std::string before, after;        // options of ffmpeg for the comparison
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

constexpr const char* kSource =
    "-f lavfi -i testsrc=s=33x17:r=10:d=0.7,noise=alls=20:allf=t -sws_flags bitexact ";

std::vector<Case> cases() {
  const std::string ffv1 = "-c:v ffv1 -level 3 -pix_fmt ";
  const std::string x264 = "-c:v libx264 -bf 2 -pix_fmt ";
  std::vector<Case> all = {
      {"h264_420", "a.mp4", "-vf scale=34:18 " + x264 + "yuv420p", "yuv420p", "", ""},
      {"h264_odd_444", "a.mp4", x264 + "yuv444p", "yuv444p", "", ""},
      {"h264_10_bit", "a.mkv", "-vf scale=34:18 " + x264 + "yuv420p10le", "yuv420p10le", "", ""},
      {"h264_grey", "a.mkv", x264 + "gray", "yuv420p", "", ""},
      {"h264_raw_stream", "a.h264", "-vf scale=34:18 " + x264 + "yuv420p", "yuv420p", "", ""},
      {"h264_ts", "a.ts", "-vf scale=34:18 " + x264 + "yuv420p", "yuv420p", "", ""},
      {"hevc", "a.mp4", "-vf scale=64:64 -c:v libx265 -x265-params log-level=none -pix_fmt yuv420p",
       "yuv420p", "", ""},
      {"mpeg4_avi", "a.avi", "-vf scale=34:18 -c:v mpeg4 -bf 2 -q:v 3", "yuv420p", "", ""},
      {"mpeg2", "a.mpg", "-vf scale=34:18,fps=25 -c:v mpeg2video -bf 2", "yuv420p", "", ""},
      {"mjpeg_full_range", "a.avi", "-c:v mjpeg -pix_fmt yuvj420p", "yuv420p", "", ""},
      {"vp8_alpha", "a.webm",
       "-vf format=rgba,colorchannelmixer=aa=0.5 -c:v libvpx -pix_fmt yuva420p -auto-alt-ref 0", "yuva420p",
       "-c:v libvpx", ""},
      {"vp9_alpha", "a.webm", "-vf format=rgba,colorchannelmixer=aa=0.5 -c:v libvpx-vp9 -pix_fmt yuva420p",
       "yuva420p", "-c:v libvpx-vp9", ""},
      {"vp9", "a.webm", "-c:v libvpx-vp9 -pix_fmt yuv444p", "yuv444p", "", ""},
      {"prores_4444", "a.mov", "-vf scale=64:64 -c:v prores_ks -profile:v 4444 -pix_fmt yuva444p10le",
       "yuva444p12le", "", ""},
      {"qtrle_rgb", "a.mov", "-c:v qtrle -pix_fmt rgb24", "rgb24", "", ""},
      {"qtrle_palette", "a.mov", "-vf scale=36:18 -c:v qtrle -pix_fmt gray", "bgra", "", "-pix_fmt bgra"},
      {"raw_packed_422", "a.avi", "-vf scale=34:18 -c:v rawvideo -pix_fmt yuyv422", "yuyv422", "", ""},
      {"raw_semiplanar", "a.nut", "-c:v rawvideo -pix_fmt nv12", "nv12", "", ""},
      {"raw_bgr", "a.avi", "-c:v rawvideo -pix_fmt bgr24", "bgr24", "", ""},
      {"raw_565", "a.nut", "-c:v rawvideo -pix_fmt rgb565le", "rgb565le", "", ""},
      {"raw_monochrome", "a.nut", "-c:v rawvideo -pix_fmt monow", "gray", "", "-pix_fmt gray"},
      {"raw_palette", "a.nut", "-c:v rawvideo -pix_fmt pal8", "bgra", "", "-pix_fmt bgra"},
      {"raw_big_endian", "a.nut", "-c:v rawvideo -pix_fmt yuv422p10be", "yuv422p10le", "",
       "-pix_fmt yuv422p10le"},
      {"huffyuv", "a.avi", "-vf scale=34:18 -c:v ffvhuff -pix_fmt yuv422p", "yuv422p", "", ""},
      {"utvideo_gbr", "a.avi", "-c:v utvideo -pix_fmt gbrp", "gbrp", "", ""},
      {"png_in_mov", "a.mov", "-c:v png -pix_fmt rgb24", "rgb24", "", ""},
      {"png_16_bit", "a.mov", "-c:v png -pix_fmt rgb48be", "rgb48le", "", "-pix_fmt rgb48le"},
      {"png_grey_16_bit", "a.mov", "-c:v png -pix_fmt gray16be", "gray16le", "", "-pix_fmt gray16le"},
      {"gif", "a.gif", "", "bgra", "", ""},
      {"apng", "a.apng", "-plays 0 -pix_fmt rgba", "rgba", "", ""},
      {"y4m", "a.y4m", "-pix_fmt yuv411p", "yuv411p", "", ""},
      {"dv", "a.dv", "-vf scale=720:576,fps=25 -pix_fmt yuv420p", "yuv420p", "", ""},
      {"wmv", "a.wmv", "-vf scale=34:18 -c:v wmv2", "yuv420p", "", ""},
      {"flv", "a.flv", "-vf scale=34:18 -c:v flv", "yuv420p", "", ""},
      {"theora", "a.ogv", "-c:v libtheora -pix_fmt yuv420p", "yuv420p", "", ""},
      {"rotated", "a.mov", "-vf scale=34:18 -c:v libx264 -pix_fmt yuv420p -metadata:s:v:0 rotate=90",
       "yuv420p", "", ""},
      {"vfr", "a.mp4", "-vf \"scale=34:18,select='not(eq(mod(n,4),1))'\" -fps_mode vfr " + x264 + "yuv420p",
       "yuv420p", "", ""},
      {"vfr_mkv", "a.mkv", "-vf \"select='gt(n,1)*not(eq(n,4))'\" -fps_mode vfr " + ffv1 + "yuv420p",
       "yuv420p", "", ""},
  };
  for (const char* format :
       {"yuv420p",     "yuv422p",      "yuv444p",  "yuv410p",  "yuv440p",   "yuva420p",    "gray",
        "ya8",         "bgr0",         "bgra",     "gray10le", "gray16le",  "yuv420p10le", "yuv422p12le",
        "yuv444p16le", "yuva444p16le", "gbrp10le", "gbrp16le", "gbrap12le", "gbrap16le"})
    all.push_back({std::string("ffv1_") + format, "a.mkv", ffv1 + format, format, "", ""});
  return all;
}

class Formats : public testing::TestWithParam<Case> {};

TEST_P(Formats, DecodesToTheBytesOfFfmpeg) {
  NEEDS_FFMPEG();
  const Case& c = GetParam();
  const ScratchFolder scratch;
  const fs::path file = scratch / c.file;
  make_clip(kSource + c.options, file);
  const std::vector<std::string> truth = ffmpeg_hashes(file, c.before, c.after);
  ASSERT_GE(truth.size(), 3u);
  EXPECT_EQ(our_hashes(file), truth);
  EXPECT_EQ(our_hashes(file, 1), truth);
  VideoReader reader(file);
  EXPECT_EQ(reader.info().layout.format, c.pixel_format);
  double last = -1;
  std::size_t frames = 0;
  for (; const auto frame = reader.next(); ++frames) {
    EXPECT_GT(frame->time_s, last);
    last = frame->time_s;
    to_bgr(*frame);
    to_luma(*frame);
  }
  EXPECT_EQ(frames, truth.size());
  EXPECT_EQ(reader.complaint(), "");
}

INSTANTIATE_TEST_SUITE_P(VideoReader, Formats, testing::ValuesIn(cases()),
                         [](const auto& c) { return c.param.name; });

TEST(VideoReader, RealClipsDecodeToTheBytesOfFfmpeg) {
  NEEDS_FFMPEG();
  const char* given = std::getenv("FRESHET_FOOTAGE");
  const fs::path footage =
      given ? fs::path(given) : fs::path(FRESHET_SOURCE_DIR) / ".." / "shared" / "footage";
  if (!fs::is_directory(footage)) GTEST_SKIP() << "NO FOOTAGE at " << footage << ": set FRESHET_FOOTAGE";
  for (const auto& [name, before] : {std::pair<std::string, std::string>{"clips/fire/candle_glass.mp4", ""},
                                     {"clips/water/fountain_jet_dyntex.avi", ""},
                                     {"clips/water/waves_aerial_foam.mp4", ""},
                                     {"elements/fire_column_alpha.webm", "-c:v libvpx"}}) {
    if (!fs::exists(footage / name)) continue;
    EXPECT_EQ(our_hashes(footage / name), ffmpeg_hashes(footage / name, before)) << name;
  }
}

TEST(VideoReader, ReportsRotationRangeColourAndAspectWithoutApplyingThem) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  const fs::path plain = scratch / "plain.mp4", turned = scratch / "turned.mp4";
  make_clip(std::string(kSource) +
                "-vf scale=64:36,setsar=4/3 -c:v libx264 -pix_fmt yuv420p -color_range tv -colorspace bt709 "
                "-color_primaries bt709 -color_trc bt709",
            plain);
  make_clip("-i '" + plain.string() + "' -c copy -metadata:s:v:0 rotate=90", turned);
  const PixelLayout upright = VideoReader(plain).info().layout;
  EXPECT_EQ(upright.rotation, 0);
  EXPECT_EQ(upright.range, 1);
  EXPECT_EQ(upright.matrix, 1);
  EXPECT_EQ(upright.sar_num, 4);
  EXPECT_EQ(upright.sar_den, 3);
  VideoReader reader(turned);
  const int turn = reader.info().layout.rotation;
  ASSERT_TRUE(turn == 90 || turn == 270) << turn;
  EXPECT_EQ(reader.info().layout.width, 64);
  EXPECT_EQ(reader.info().layout.height, 36);
  // What a player shows: ffmpeg turns the picture itself unless told not to.
  make_clip("-i '" + turned.string() + "' -c:v ffv1 -pix_fmt yuv420p", scratch / "shown.mkv");
  const Frame native = *reader.next(), shown = *VideoReader(scratch / "shown.mkv").next();
  cv::Mat upright_luma;
  cv::rotate(to_luma(native), upright_luma,
             turn == 90 ? cv::ROTATE_90_CLOCKWISE : cv::ROTATE_90_COUNTERCLOCKWISE);
  ASSERT_EQ(upright_luma.size(), cv::Size(36, 64));
  EXPECT_EQ(cv::norm(upright_luma, to_luma(shown), cv::NORM_INF), 0);
}

TEST(VideoReader, SetsUprightWhatLiesAsFfmpegDoes) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  const fs::path plain = scratch / "plain.mp4";
  make_clip(std::string(kSource) + "-vf scale=64:36,setsar=4/3 -c:v libx264 -pix_fmt yuv420p", plain);
  for (const int turn : {90, 180, 270}) {
    const fs::path turned = scratch / (std::to_string(turn) + ".mp4"), shown = scratch / "shown.mkv";
    make_clip("-i '" + plain.string() + "' -c copy -metadata:s:v:0 rotate=" + std::to_string(turn), turned);
    make_clip("-y -i '" + turned.string() + "' -c:v ffv1 -pix_fmt yuv420p", shown);
    VideoReader reader(turned, 0, {.upright = true}), player(shown);
    EXPECT_NE(reader.info().turned, 0);
    EXPECT_EQ(reader.info().layout.rotation, 0);
    EXPECT_EQ(reader.info().layout.sar_num, turn == 180 ? 4 : 3);
    EXPECT_EQ(reader.info().layout.sar_den, turn == 180 ? 3 : 4);
    while (const auto theirs = player.next()) {
      const auto ours = reader.next();
      ASSERT_TRUE(ours);
      EXPECT_EQ(frame_md5(*ours), frame_md5(*theirs)) << turn;
    }
    EXPECT_FALSE(reader.next());
  }
}

TEST(VideoReader, JpegVideoIsFullRange) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-c:v mjpeg -pix_fmt yuvj422p", scratch / "a.avi");
  EXPECT_EQ(VideoReader(scratch / "a.avi").info().layout.range, 2);
}

TEST(VideoReader, TimesFollowTheStampsOfAVariableRate) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-vf \"select='not(eq(n,0))*not(eq(n,3))'\" -fps_mode vfr -c:v ffv1",
            scratch / "a.mkv");
  VideoReader reader(scratch / "a.mkv");
  std::vector<double> times;
  while (const auto frame = reader.next()) times.push_back(frame->time_s);
  const std::vector<double> truth = {0, 0.1, 0.3, 0.4, 0.5};  // frames 1 2 4 5 6 of 10 a second
  ASSERT_EQ(times.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_NEAR(times[i], truth[i], 1e-6);
}

TEST(VideoReader, ReadsPatternsAndFoldersInTheOrderOfTheirNumbers) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  const fs::path folder = scratch / "frames";
  fs::create_directory(folder);
  make_clip(std::string(kSource) + "-start_number 1007 -pix_fmt rgb24", folder / "f%d.png");
  make_clip(std::string(kSource) + "-c:v ffv1 -pix_fmt bgr0", scratch / "a.mkv");
  put_bytes(folder / "readme.txt", {'x'});
  const auto truth = ffmpeg_hashes(scratch / "a.mkv", "", "-pix_fmt rgb24");
  EXPECT_EQ(our_hashes(folder / "f%d.png"), truth);
  EXPECT_EQ(our_hashes(folder), truth);

  // 7, 8, .. 13: as text 10 would come before 7.
  const auto name = [&](int number) {
    return folder / std::string("f").append(std::to_string(number)).append(".png");
  };
  for (int i = 7; i < 14; ++i) fs::rename(name(1000 + i), name(i));
  EXPECT_EQ(our_hashes(folder), truth);
  EXPECT_EQ(our_hashes(folder / "f%d.png"), truth);

  fs::remove(folder / "f9.png");
  VideoReader reader(folder / "f%d.png");
  std::vector<double> times;
  while (const auto frame = reader.next()) times.push_back(frame->time_s);
  ASSERT_EQ(times.size(), 6u);
  EXPECT_NEAR(times[2], 3 / 25.0, 1e-9);  // its number keeps its place in time
  EXPECT_EQ(reader.complaint(), "1 of 7 numbers are missing between f7.png and f13.png");
}

TEST(VideoReader, ABrokenPictureOfASequenceIsPassedOverAndTold) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-start_number 1 -pix_fmt rgb24", scratch / "f%03d.png");
  put_bytes(scratch / "f003.png", {'n', 'o'});
  VideoReader reader(scratch / "f%03d.png");
  int frames = 0;
  while (reader.next()) ++frames;
  EXPECT_EQ(frames, 6);
  EXPECT_EQ(reader.complaint(), "1 of 7 pictures could not be decoded, first f003.png");
}

TEST(VideoReader, RefusesASequenceWhoseSizeChanges) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-start_number 1 -pix_fmt rgb24", scratch / "f%03d.png");
  make_clip("-f lavfi -i testsrc=s=40x20 -frames:v 1 -pix_fmt rgb24", scratch / "f003.png");
  const std::string fault = fault_of(ErrorKind::kInput, [&] { our_hashes(scratch / "f%03d.png"); });
  EXPECT_NE(fault.find("f003.png: frame 2 is 40x20 rgb24, the frames before it are 33x17 rgb24"),
            std::string::npos)
      << fault;
}

TEST(VideoReader, NamesTheFileAndTheFault) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  const auto fault = [&](const std::string& name) {
    const std::string text = fault_of(ErrorKind::kInput, [&] { VideoReader(scratch / name); });
    EXPECT_EQ(text.find((scratch / name).string() + ": "), 0u) << text;
    return text;
  };
  EXPECT_NE(fault("missing.mp4").find("there is no such file"), std::string::npos);
  EXPECT_NE(fault("f%05d.png").find("matches this pattern"), std::string::npos);

  put_bytes(scratch / "empty.mp4", {});
  EXPECT_NE(fault("empty.mp4").find("the file is empty"), std::string::npos);

  fs::create_directory(scratch / "folder");
  put_bytes(scratch / "folder" / "notes.txt", {'x'});
  EXPECT_NE(fault("folder").find("holds no pictures"), std::string::npos);

  make_clip(std::string(kSource) + "-loop 0", scratch / "moving.webp");
  EXPECT_NE(fault("moving.webp").find("animated WebP"), std::string::npos);

  const std::string words = "These are words, and no video at all. ";
  put_bytes(scratch / "words.txt", {words.begin(), words.end()});
  EXPECT_NE(fault("words.txt").find("not a video"), std::string::npos);
  put_bytes(scratch / "words.mp4", {words.begin(), words.end()});
  EXPECT_NE(fault("words.mp4").find("not a video"), std::string::npos);

  make_clip("-f lavfi -i sine=d=0.5 -c:a aac", scratch / "sound.mp4");
  EXPECT_NE(fault("sound.mp4").find("holds sound but no video stream"), std::string::npos);

  make_clip(std::string(kSource) + "-vf scale=34:18 -c:v libx264 -pix_fmt yuv420p", scratch / "whole.mp4");
  std::vector<char> bytes = bytes_of(scratch / "whole.mp4");
  bytes.resize(bytes.size() / 2);  // the index of a plain MP4 lies at its end
  put_bytes(scratch / "cut.mp4", bytes);
  EXPECT_NE(fault("cut.mp4").find("moov atom not found"), std::string::npos);
}

TEST(VideoReader, AFragmentedFileIsWhole) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(
      std::string(kSource) + "-vf scale=34:18 -c:v libx264 -g 2 -pix_fmt yuv420p -movflags frag_keyframe",
      scratch / "a.mp4");
  VideoReader reader(scratch / "a.mp4");
  int frames = 0;
  while (reader.next()) ++frames;
  EXPECT_EQ(frames, 7);
  EXPECT_EQ(reader.complaint(), "");
}

TEST(VideoReader, OpensNoOtherFileThatAPlaylistNames) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-vf scale=34:18 -c:v libx264 -pix_fmt yuv420p", scratch / "secret.ts");
  const std::string list = "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\n" +
                           (scratch / "secret.ts").string() + "\n#EXT-X-ENDLIST\n";
  put_bytes(scratch / "list.m3u8", {list.begin(), list.end()});
  put_bytes(scratch / "list.mp4", {list.begin(), list.end()});
  fault_of(ErrorKind::kInput, [&] { VideoReader(scratch / "list.m3u8"); });
  fault_of(ErrorKind::kInput, [&] { VideoReader(scratch / "list.mp4"); });
}

TEST(VideoReader, AFileWithAPercentSignOrAColonInItsNameIsThatFile) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-c:v ffv1", scratch / "a.mkv");
  fs::copy(scratch / "a.mkv", scratch / "f%05d.mkv");
  fs::copy(scratch / "a.mkv", scratch / "concat:b.mkv");
  EXPECT_EQ(our_hashes(scratch / "f%05d.mkv"), our_hashes(scratch / "a.mkv"));
  EXPECT_EQ(our_hashes(scratch / "concat:b.mkv"), our_hashes(scratch / "a.mkv"));
}

TEST(FrameMd5, PrintsTheLinesOfFfmpeg) {
  NEEDS_FFMPEG();
  const ScratchFolder scratch;
  make_clip(std::string(kSource) + "-c:v ffv1 -pix_fmt yuv420p", scratch / "a.mkv");
  make_clip("-bitexact -i '" + (scratch / "a.mkv").string() + "' -f framemd5 -fflags bitexact",
            scratch / "truth");
  const std::vector<char> bytes = bytes_of(scratch / "truth");
  VideoReader reader(scratch / "a.mkv");
  std::string ours = framemd5_header(reader.info().layout, 1, 10);
  std::int64_t n = 0;
  while (const auto frame = reader.next()) ours += framemd5_line(*frame, n++, 1) + "\n";
  EXPECT_EQ(ours, std::string(bytes.begin(), bytes.end()));
}

}  // namespace
}  // namespace freshet::media
