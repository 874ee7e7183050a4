// A disk that fills up: said by name, nothing half-written is left, and the store is as it was.

#include <gtest/gtest.h>

#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

/// No file may grow beyond this, and the process is told by an error, as on a full disk.
std::string at_most(std::uintmax_t bytes) { return "trap '' XFSZ; ulimit -f " + std::to_string(bytes / 512); }

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename());
  return names;
}

TEST(FullDisk, ANewStoreIsNotLeftEmpty) {
  const WorkFolder folder;
  const Outcome outcome = folder.freshet_after(at_most(600 << 10), {"ingest", "a.store", sample().clips});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_NE(outcome.err.find("a.store: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("free space on the disk and run again"), std::string::npos) << outcome.err;
  EXPECT_TRUE(names_in(folder.path()).empty());
}

TEST(FullDisk, AStoreIsAsItWasWhenAnotherClipFindsNoRoom) {
  const WorkFolder folder;
  ASSERT_EQ(folder.freshet({"ingest", "a.store", sample().clips / "river"}).exit_code, 0);
  const std::string before = digest(folder / "a.store");
  const Outcome outcome = folder.freshet_after(at_most(fs::file_size(folder / "a.store") + (300 << 10)),
                                               {"ingest", "a.store", sample().clips / "fall"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_NE(outcome.err.find("a.store: "), std::string::npos) << outcome.err;
  EXPECT_EQ(digest(folder / "a.store"), before);
  EXPECT_EQ(folder.freshet({"store", "verify", "a.store"}).exit_code, 0);
  // With room again, the same command ends what it began.
  EXPECT_EQ(folder.freshet({"ingest", "a.store", sample().clips / "fall"}).exit_code, 0);
}

TEST(FullDisk, AnAnimationThatFindsNoRoomLeavesNothing) {
  const WorkFolder folder;
  fs::create_directories(folder / "frames");
  fs::create_directories(folder / "out");
  ASSERT_EQ(
      folder.freshet({"query", "label", sample().store, sample().still, "--frames", "16", "-o", "a.json"})
          .exit_code,
      0);
  for (const char* name : {"out/a.mkv", "out/a.mp4", "out/a.webp", "out/a.apng", "out/%05d.png"}) {
    const Outcome outcome = folder.freshet_after(
        at_most(10 << 10), {"synth", "animate", sample().store, sample().still, "--whole", "--frames", "16",
                            "--assignment", "a.json", "-o", name});
    EXPECT_EQ(outcome.exit_code, 1) << name << ": " << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("Make room on the disk"), std::string::npos) << outcome.err;
    EXPECT_TRUE(names_in(folder / "out").empty()) << name;
  }
}

TEST(FullDisk, ARealOneIsAnsweredTheSame) {
  const WorkFolder folder;
  if (folder.run({"unshare", "-rm", "sh", "-c", "mount -t tmpfs t /mnt"}).exit_code != 0)
    GTEST_SKIP() << "needs a small file system: run where unshare -rm and mount work";
  fs::create_directories(folder / "small");
  const Outcome outcome =
      folder.run({"unshare", "-rm", "sh", "-c",
                  "mount -t tmpfs -o size=1m t small && \"$@\"; code=$?; ls -A small; exit $code", "sh",
                  executable(), "ingest", "small/a.store", sample().clips});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  EXPECT_EQ(outcome.out, "") << "nothing is left in the folder";
  EXPECT_NE(outcome.err.find("small/a.store: "), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("free space"), std::string::npos) << outcome.err;
}

TEST(FullDisk, AStoreIsReadWhereThereIsNoRoomForItsLockFile) {
  const WorkFolder folder;
  if (folder.run({"unshare", "-rm", "sh", "-c", "mount -t tmpfs t /mnt"}).exit_code != 0)
    GTEST_SKIP() << "needs a small file system: run where unshare -rm and mount work";
  fs::create_directories(folder / "small");
  const auto on_full_disk = [&](const std::vector<std::string>& command) {
    std::vector<std::string> words{
        "unshare",
        "-rm",
        "sh",
        "-c",
        "mount -t tmpfs -o size=$1 t small && cp \"$2\" small/a.store && shift 2 || exit 9; "
        "cat /dev/zero > small/filler 2> rest; \"$@\"",
        "sh",
        std::to_string(fs::file_size(sample().store) + (40 << 10)),
        sample().store,
        executable()};
    words.insert(words.end(), command.begin(), command.end());
    return folder.run(words);
  };
  const Outcome read = on_full_disk({"store", "digest", "small/a.store"});
  EXPECT_EQ(read.exit_code, 0) << read.err;
  EXPECT_EQ(read.out, digest(sample().store));
  const Outcome written = on_full_disk({"index", "--rebuild", "small/a.store"});
  EXPECT_EQ(written.exit_code, 1);
  EXPECT_NE(written.err.find("small/a.store: cannot be opened (No space left on device)"), std::string::npos)
      << written.err;
  EXPECT_NE(written.err.find("free space on the disk and run again"), std::string::npos) << written.err;
}

}  // namespace
}  // namespace freshet::tools
