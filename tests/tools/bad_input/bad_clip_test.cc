// Clips that cannot be taken: said by name, with a remedy, and the store is left as it was.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

class BadClip : public testing::Test {
 protected:
  void SetUp() override {
    if (folder_.run({"ffmpeg", "-version"}).exit_code != 0)
      GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  }

  /// Makes a clip from the sample's with these options of ffmpeg.
  void encode(const std::string& name, std::vector<std::string> options) {
    std::vector<std::string> command{"ffmpeg", "-v", "error", "-i", sample().clips / "fall/1.mkv"};
    command.insert(command.end(), options.begin(), options.end());
    command.push_back(name);
    folder_.run(command);
    ASSERT_TRUE(fs::exists(folder_ / name));
  }

  /// Neither is a new store made of it, nor an old one changed.
  void expect_refusal(const std::string& clip, const std::string& fault, const std::string& remedy) {
    const Outcome fresh = folder_.freshet({"ingest", "new.store", clip});
    EXPECT_EQ(fresh.exit_code, 1) << fresh.err;
    EXPECT_NE(fresh.err.find(clip), std::string::npos) << fresh.err;
    EXPECT_NE(fresh.err.find(fault), std::string::npos) << fresh.err;
    EXPECT_NE(fresh.err.find(remedy), std::string::npos) << fresh.err;
    EXPECT_FALSE(fs::exists(folder_ / "new.store"));
    EXPECT_FALSE(fs::exists(folder_ / "new.store-lock"));
    const fs::path store = copy_of_store(folder_);
    const Outcome old = folder_.freshet({"ingest", store, clip});
    EXPECT_EQ(old.exit_code, 1) << old.err;
    EXPECT_NE(old.err.find(fault), std::string::npos) << old.err;
    EXPECT_EQ(digest(store), sample_digest());
    fs::remove(store);
  }

  WorkFolder folder_;
};

TEST_F(BadClip, TextNamedAsAVideo) {
  folder_.file("text.mp4", "No video, but a text.\n");
  expect_refusal("text.mp4", "not a video that FFmpeg can read", "leave it out");
}

TEST_F(BadClip, HighDynamicRange) {
  encode("pq.mkv", {"-pix_fmt", "yuv420p10le", "-c:v", "ffv1", "-color_trc", "smpte2084", "-color_primaries",
                    "bt2020"});
  expect_refusal("pq.mkv", "it is HDR (PQ)", "export it as SDR");
  encode("hlg.mkv", {"-pix_fmt", "yuv420p10le", "-c:v", "ffv1", "-color_trc", "arib-std-b67"});
  expect_refusal("hlg.mkv", "it is HDR (HLG)", "export it as SDR");
  const Outcome asked = folder_.freshet({"ingest", "sdr.store", "pq.mkv", "--sdr", "--dry-run"});
  EXPECT_EQ(asked.exit_code, 0) << asked.err;
  EXPECT_EQ(asked.err.find("HDR"), std::string::npos) << asked.err;
}

TEST_F(BadClip, AnEmptyFile) {
  folder_.file("empty.mp4", "");
  expect_refusal("empty.mp4", "the file is empty", "download it again");
}

TEST_F(BadClip, AFileThatIsNotThere) { expect_refusal("missing.mp4", "no such file", "Check the path"); }

TEST_F(BadClip, AFolderWithoutClips) {
  fs::create_directories(folder_ / "nothing");
  expect_refusal("nothing", "no clip was found", "Give video files");
}

TEST_F(BadClip, AnMp4CutBeforeItsIndex) {
  encode("whole.mp4", {"-c:v", "libx264"});
  folder_.file("cut.mp4", text_of(folder_ / "whole.mp4").substr(0, 20000));
  expect_refusal("cut.mp4", "moov atom not found", "leave it out");
}

TEST_F(BadClip, AMatroskaCutInTheMiddleIsSaidToBeCut) {
  encode("whole.mkv", {"-vf", "loop=loop=3:size=32", "-c:v", "ffv1"});
  const std::string whole = text_of(folder_ / "whole.mkv");
  folder_.file("cut.mkv", whole.substr(0, whole.size() / 2));
  const Outcome outcome = folder_.freshet({"ingest", "a.store", "cut.mkv", "--force", "--no-index"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("cut.mkv: file is truncated or damaged"), std::string::npos) << outcome.err;
}

TEST_F(BadClip, NoFrames) {
  encode("none.avi", {"-frames:v", "0", "-c:v", "ffv1"});
  expect_refusal("none.avi", "no frame", "leave it out");
}

TEST_F(BadClip, OneFrame) {
  encode("one.mkv", {"-frames:v", "1", "-c:v", "ffv1"});
  expect_refusal("one.mkv", "too short: 1 frame,", "Film for four seconds or more");
}

// FFmpeg knows formats by their first bytes, whatever the name, and opens what they refer to.
TEST_F(BadClip, AListOfThingsToFetchIsNoClip) {
  encode("whole.mkv", {"-c:v", "ffv1"});
  const std::vector<std::pair<std::string, std::string>> lists{
      {"sdp.mp4",
       "v=0\no=- 0 0 IN IP4 127.0.0.1\ns=x\nc=IN IP4 127.0.0.1\nt=0 0\nm=video 54321 RTP/AVP 96\n"
       "a=rtpmap:96 H264/90000\n"},
      {"concat.mp4", "ffconcat version 1.0\nfile whole.mkv\n"},
      {"hls.mp4", "#EXTM3U\n#EXT-X-TARGETDURATION:2\n#EXTINF:2,\nwhole.mkv\n#EXT-X-ENDLIST\n"},
      {"dash.mp4",
       "<?xml version=\"1.0\"?>\n<MPD xmlns=\"urn:mpeg:dash:schema:mpd:2011\" "
       "profiles=\"urn:mpeg:dash:profile:isoff-on-demand:2011\" type=\"static\">"
       "<Period><AdaptationSet mimeType=\"video/mp4\"><Representation><BaseURL>whole.mkv</BaseURL>"
       "</Representation></AdaptationSet></Period></MPD>\n"}};
  for (const auto& [name, text] : lists) {
    folder_.file(name, text);
    const auto start = std::chrono::steady_clock::now();
    expect_refusal(name, "that clips and pictures are not read from", "leave it out");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20)) << name;
  }
}

TEST_F(BadClip, APipeIsNotWaitedFor) {
  ASSERT_EQ(::mkfifo((folder_ / "pipe.mp4").c_str(), 0600), 0);
  expect_refusal("pipe.mp4", "is neither a regular file nor a folder", "Give video files");
}

TEST_F(BadClip, SoundAlone) {
  folder_.run({"ffmpeg", "-v", "error", "-f", "lavfi", "-i", "sine", "-t", "1", "sound.mp4"});
  expect_refusal("sound.mp4", "holds sound but no video stream", "Leave it out");
}

TEST_F(BadClip, SmallerThanAPatch) {
  encode("tiny.mkv", {"-vf", "scale=16:16", "-c:v", "ffv1"});
  expect_refusal("tiny.mkv", "16 x 16 px is too small", "at least 48 x 48");
}

TEST_F(BadClip, OddSizesAreFine) {
  encode("odd.mkv", {"-vf", "scale=193:145", "-pix_fmt", "yuv444p", "-c:v", "ffv1"});
  ASSERT_EQ(folder_.freshet({"ingest", "odd.store", "odd.mkv"}).exit_code, 0);
  const Outcome outcome = folder_.freshet(
      {"synth", "animate", "odd.store", sample().still, "--whole", "--frames", "8", "-o", "out.mp4"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(BadClip, AmongGoodOnesItIsNamedAndTheOthersAreTaken) {
  folder_.file("text.mp4", "No video, but a text.\n");
  const Outcome outcome =
      folder_.freshet({"ingest", "a.store", sample().clips / "fall/1.mkv", "text.mp4", "--no-index"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("1 added, 0 already there, 0 refused, 1 failed"), std::string::npos)
      << outcome.out;
  EXPECT_NE(outcome.err.find("text.mp4 failed"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace freshet::tools
