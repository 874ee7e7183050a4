#include "store/rewrite/rewrite.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <stop_token>

#include "tests/harness/fault.h"
#include "tests/store/raw_file.h"

namespace freshet::store {
namespace {

namespace fs = std::filesystem;

const Rebuildable kIndex{.columns = {"patch.words"}, .blobs = {"codebook"}};
const TestClip kA{.name = "water/a.mp4", .frames = 18, .seed = 1}, kB{.name = "water/b.mp4", .seed = 2},
    kC{.name = "fire/c.mp4", .planes = {{33, 65, 2}}, .frames = 5, .seed = 3, .rows = 900};

void make(const fs::path& file, std::initializer_list<TestClip> clips, const std::string& settings = "{}") {
  Store store = Store::create(file, settings);
  for (const TestClip& clip : clips) add_clip(store, clip);
}

/// As freshet index leaves it: a blob, and a column in every clip.
void add_index(const fs::path& file) {
  Store store = Store::open_write(file);
  const std::vector<std::byte> words(81'000, std::byte{7}), codebook(3 << 20, std::byte{9});
  std::vector<Store::Column> columns;
  const Snapshot snapshot = store.snapshot();
  for (const ClipId id : snapshot.clips())
    columns.push_back({id, "patch.words", std::span(words).first(81 * snapshot.clip(id).rows), 81});
  const Store::Blob blob{"codebook", codebook};
  store.write({&blob, 1}, columns);
}

std::string digest(const fs::path& file) { return Store::open_read(file).snapshot().digest(); }

void expect_whole(const fs::path& file) {
  const std::vector<std::string> faults = Store::open_read(file).snapshot().verify();
  EXPECT_TRUE(faults.empty()) << faults.front();
  EXPECT_FALSE(fs::exists(file.string() + ".making"));
}

/// Turns a bit in the middle of the first record that `is_meant`, where it lies in the file. (Through LMDB the old
/// copy would stay on a free page, and be found there.)
void damage(const fs::path& file,
            const std::function<bool(const std::string& table, const std::string& key)>& is_meant) {
  compact(file);
  std::string meant;
  each_record(file, [&](const std::string& table, const std::string& key, std::string& value) {
    if (meant.empty() && is_meant(table, key)) meant = value;
    return false;
  });
  std::vector<char> bytes = file_bytes(file);
  const auto at = std::search(bytes.begin(), bytes.end(), meant.begin(), meant.end());
  ASSERT_TRUE(!meant.empty() && at != bytes.end());
  at[static_cast<std::ptrdiff_t>(meant.size() / 2)] ^= 4;
  write_file(file, bytes);
}

class Rewrite : public testing::Test {
 protected:
  const ScratchFolder folder_;
  const fs::path a_ = folder_ / "a", b_ = folder_ / "b", c_ = folder_ / "c";
};

TEST_F(Rewrite, CompactionKeepsTheDigestAndDropsFreePages) {
  make(a_, {kA, kB, kC});
  add_index(a_);
  const std::string before = digest(a_);
  {
    Store store = Store::open_write(a_);
    std::vector<std::byte> noise(2 << 20);
    std::mt19937_64 random(3);
    for (auto& byte : noise) byte = static_cast<std::byte>(random());
    const Store::Blob blob{"index", noise};
    store.write({&blob, 1});
    const std::string erased[] = {"index"};
    store.write({}, {}, erased);
  }
  const FileSizes expected = compacted_size(a_), sizes = compact(a_);
  EXPECT_EQ(sizes.before, expected.before);
  EXPECT_EQ(sizes.after, expected.after);
  EXPECT_EQ(sizes.after, fs::file_size(a_));
  EXPECT_LT(sizes.after + (2 << 20), sizes.before);
  EXPECT_EQ(digest(a_), before);
  expect_whole(a_);
  const std::vector<char> bytes = file_bytes(a_);
  compact(a_);
  EXPECT_EQ(file_bytes(a_), bytes);
  Store store = Store::open_write(a_);
  EXPECT_EQ(add_clip(store, {.name = "d", .seed = 4}), ClipId{3});
  EXPECT_TRUE(store.snapshot().verify().empty());
}

// Its file is never larger than LMDB's own, written in order.
TEST_F(Rewrite, ACompactedStoreIsSmallerThanLmdbsOwnCompaction) {
  make(a_, {kA, kB, kC});
  add_index(a_);
  MDB_env* env = nullptr;
  mdb_env_create(&env);
  mdb_env_set_mapsize(env, std::size_t{1} << 30);
  ASSERT_EQ(mdb_env_open(env, a_.c_str(), MDB_NOSUBDIR | MDB_NOLOCK | MDB_RDONLY, 0666), 0);
  ASSERT_EQ(mdb_env_set_maxdbs(env, 8), EINVAL);
  fs::create_directory(folder_ / "copy");
  const int fd = ::open((folder_ / "copy/data").c_str(), O_CREAT | O_WRONLY, 0666);
  ASSERT_EQ(mdb_env_copyfd2(env, fd, MDB_CP_COMPACT), 0);
  ::close(fd);
  mdb_env_close(env);
  EXPECT_LE(compact(a_).after, fs::file_size(folder_ / "copy/data"));
}

TEST_F(Rewrite, CompactionRefusesWhatIsOpenAndLeavesALinkALink) {
  make(a_, {kA});
  fs::create_symlink("a", b_);
  fs::permissions(a_, fs::perms::owner_read | fs::perms::owner_write);
  {
    const Snapshot snapshot = Store::open_read(a_).snapshot();
    EXPECT_EQ(kind_of([&] { compact(a_); }), ErrorKind::kIo);
  }
  compact(b_);
  EXPECT_TRUE(fs::is_symlink(b_));
  EXPECT_EQ(fs::status(a_).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  expect_whole(a_);
}

TEST_F(Rewrite, CompactionSaysThatAnotherNameKeepsTheOldFile) {
  make(a_, {kA});
  EXPECT_EQ(compact(a_).old_names, 0u);
  fs::create_hard_link(a_, b_);
  EXPECT_EQ(compact(a_).old_names, 1u);
  EXPECT_FALSE(fs::equivalent(a_, b_));
  expect_whole(b_);
}

TEST_F(Rewrite, StoppedItLeavesEverythingAsItWas) {
  make(a_, {kA, kB});
  make(b_, {kC});
  const std::vector<char> before = file_bytes(a_);
  std::stop_source stop;
  stop.request_stop();
  const Job job{.stop = stop.get_token()};
  const fs::path files[] = {a_, b_};
  EXPECT_EQ(kind_of([&] { compact(a_, job); }), ErrorKind::kCancelled);
  EXPECT_EQ(kind_of([&] { merge(files, c_, kIndex, job); }), ErrorKind::kCancelled);
  EXPECT_EQ(kind_of([&] { repair(a_, c_, kIndex, job); }), ErrorKind::kCancelled);
  EXPECT_EQ(file_bytes(a_), before);
  EXPECT_FALSE(fs::exists(c_) || fs::exists(c_.string() + ".making") || fs::exists(a_.string() + ".making"));
}

TEST_F(Rewrite, WithoutAClipItIsAsIfTheClipHadNeverBeen) {
  make(a_, {kA, kB, kC});
  make(b_, {kC, kA});
  add_index(a_);
  const std::string names[] = {kB.name};
  remove_clips(a_, names, kIndex);
  EXPECT_EQ(digest(a_), digest(b_));
  expect_whole(a_);
  Store store = Store::open_write(a_);
  EXPECT_TRUE(reads_back(store.snapshot(), ClipId{2}, kC));
  EXPECT_EQ(add_clip(store, kB), ClipId{3});
}

TEST_F(Rewrite, AClipThatIsNotThereIsNotRemoved) {
  make(a_, {kA});
  const std::vector<char> before = file_bytes(a_);
  const std::string names[] = {kA.name, "none"};
  EXPECT_EQ(kind_of([&] { remove_clips(a_, names, kIndex); }), ErrorKind::kNotFound);
  EXPECT_EQ(file_bytes(a_), before);
}

TEST_F(Rewrite, MergedStoresAreWhatOneIngestMakes) {
  make(a_, {kA, kC});
  make(b_, {kB});
  make(c_, {kA, kB, kC});
  add_index(a_);
  const fs::path files[] = {a_, b_};
  const MergeReport report = merge(files, folder_ / "m", kIndex);
  EXPECT_EQ(report.clips, 3u);
  EXPECT_TRUE(report.index_left_out);
  EXPECT_EQ(report.bytes, fs::file_size(folder_ / "m"));
  EXPECT_EQ(digest(folder_ / "m"), digest(c_));
  expect_whole(folder_ / "m");
  const Store store = Store::open_read(folder_ / "m");
  EXPECT_TRUE(reads_back(store.snapshot(), ClipId{2}, kB));
  EXPECT_EQ(kind_of([&] { merge(files, folder_ / "m", kIndex); }), ErrorKind::kIo);
}

TEST_F(Rewrite, ClipsAreMergedInTheOrderThatIsAsked) {
  make(a_, {kA, kC});
  make(b_, {kB});
  const fs::path files[] = {a_, b_};
  const std::string order[] = {kB.name, "none", kC.name};
  EXPECT_EQ(merge(files, folder_ / "m", kIndex, {}, order).clips, 3u);
  expect_whole(folder_ / "m");
  const Store store = Store::open_read(folder_ / "m");
  EXPECT_TRUE(reads_back(store.snapshot(), ClipId{0}, kB));
  EXPECT_TRUE(reads_back(store.snapshot(), ClipId{1}, kC));
  EXPECT_TRUE(reads_back(store.snapshot(), ClipId{2}, kA));
}

TEST_F(Rewrite, AClipOfTwoStoresIsMergedOnce) {
  make(a_, {kA, kB});
  make(b_, {kB, kC, kA});
  make(c_, {kA, kB, kC});
  const fs::path files[] = {a_, b_};
  const MergeReport report = merge(files, folder_ / "m", kIndex);
  EXPECT_EQ(report.doubles.size(), 2u);
  EXPECT_EQ(report.doubles.front().name, kB.name);
  EXPECT_EQ(digest(folder_ / "m"), digest(c_));
}

TEST_F(Rewrite, StoresThatDoNotGoTogetherAreNotMerged) {
  make(a_, {kA});
  make(b_, {kB}, "{\"patch\": 32}");
  const fs::path files[] = {a_, b_};
  EXPECT_NE(fault_of([&] { merge(files, folder_ / "m", kIndex); }).find("other settings"), std::string::npos);
  make(c_, {});
  {
    Store store = Store::open_write(c_);
    ClipWriter writer = write_clip(store, kA);
    ClipRecord record = kA.record();
    record.source_hash = "another";
    writer.commit(record);
  }
  const fs::path same_name[] = {a_, c_};
  EXPECT_NE(fault_of([&] { merge(same_name, folder_ / "m", kIndex); }).find("another source"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "m"));
}

TEST_F(Rewrite, AWholeStoreIsRepairedIntoItself) {
  make(a_, {kA, kB, kC});
  add_index(a_);
  const RepairReport report = repair(a_, b_, kIndex);
  EXPECT_TRUE(report.lost.empty() && report.lost_blobs.empty() && !report.index_left_out);
  EXPECT_EQ(report.clips, 3u);
  EXPECT_EQ(digest(b_), digest(a_));
  compact(a_);
  EXPECT_EQ(file_bytes(a_), file_bytes(b_));
}

// Of a record that is damaged, its clip is lost and named; all others are saved.
TEST_F(Rewrite, ADamagedRecordCostsItsClipAlone) {
  make(a_, {kA, kB, kC});
  make(c_, {kA, kC});
  damage(a_, [](const std::string& table, const std::string& key) {
    return table == "tiles" && key.starts_with(std::string("\0\0\0\1\1", 5));
  });
  EXPECT_EQ(kind_of([&] { compact(a_); }), ErrorKind::kDamaged);
  const RepairReport report = repair(a_, b_, kIndex);
  ASSERT_EQ(report.lost.size(), 1u);
  EXPECT_EQ(report.lost[0].name, kB.name);
  EXPECT_EQ(report.lost[0].source_hash, "hash of " + kB.name);
  EXPECT_NE(report.lost[0].fault.find("clip 1, flow"), std::string::npos) << report.lost[0].fault;
  EXPECT_EQ(digest(b_), digest(c_));
  expect_whole(b_);
}

TEST_F(Rewrite, ADamagedIndexCostsNoClip) {
  make(a_, {kA, kB});
  const std::string without = digest(a_);
  add_index(a_);
  damage(a_, [](const std::string& table, const std::string& key) {
    return table == "columns" && key.find("words") != std::string::npos;
  });
  const RepairReport report = repair(a_, b_, kIndex);
  EXPECT_TRUE(report.lost.empty());
  EXPECT_TRUE(report.index_left_out);
  EXPECT_EQ(digest(b_), without);
}

TEST_F(Rewrite, ALostClipRecordIsSaidToBeLost) {
  make(a_, {kA, kB});
  damage(a_, [](const std::string& table, const std::string& key) {
    return table == "clips" && key.back() == 0;
  });
  const RepairReport report = repair(a_, b_, kIndex);
  ASSERT_EQ(report.lost.size(), 1u);
  EXPECT_EQ(report.lost[0].id, ClipId{0});
  EXPECT_TRUE(report.lost[0].name.empty());
  EXPECT_EQ(report.clips, 1u);
  EXPECT_TRUE(reads_back(Store::open_read(b_).snapshot(), ClipId{1}, kB));
}

// A transaction leaves the copies that it changed on free pages. They too fit their keys, and the account.
TEST_F(Rewrite, AnOlderCopyOfARecordStandsInForADamagedOne) {
  make(a_, {kA, kB});
  const std::string before = digest(a_);
  each_record(a_, [&](const std::string& table, const std::string& key, std::string& value) {
    if (table != "clips" || key.back() != 0) return false;
    value.back() ^= 1;
    return true;
  });
  EXPECT_TRUE(repair(a_, b_, kIndex).lost.empty());
  EXPECT_EQ(digest(b_), before);
}

// Whatever is done to a file: what comes out is a whole store, and each of its clips is one that went in.
TEST_F(Rewrite, WhatIsSavedOfAnyDamageIsTrue) {
  make(a_, {kA, kB, kC});
  add_index(a_);
  const std::vector<char> whole = file_bytes(a_);
  std::mt19937_64 random(29);
  int saved = 0, refused = 0;
  for (int round = 0; round < 120; ++round) {
    std::vector<char> bytes = whole;
    const std::size_t pages = bytes.size() / 4096;
    for (std::uint64_t i = 0; i < 1 + random() % 4; ++i) {
      const std::size_t page = random() % pages * 4096, other = random() % pages * 4096;
      switch (random() % 4) {
        case 0:
          bytes[random() % bytes.size()] ^= static_cast<char>(1u << random() % 8);
          break;
        case 1:
          std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(page), 4096, '\0');
          break;
        case 2:
          std::copy_n(whole.begin() + static_cast<std::ptrdiff_t>(other), 4096,
                      bytes.begin() + static_cast<std::ptrdiff_t>(page));
          break;
        default:
          if (i == 0) bytes[page + random() % 200] ^= static_cast<char>(1u << random() % 8);
      }
    }
    if (random() % 8 == 0) bytes.resize(random() % bytes.size());
    write_file(c_, bytes);
    fs::remove(b_);
    try {
      const RepairReport report = repair(c_, b_, kIndex);
      const Store store = Store::open_read(b_);
      const Snapshot snapshot = store.snapshot();
      ASSERT_TRUE(snapshot.verify().empty()) << round;
      ASSERT_EQ(snapshot.clips().size(), report.clips);
      ASSERT_EQ(report.clips + report.lost.size() + report.unknown, 3u) << round;
      const TestClip* const clips[] = {&kA, &kB, &kC};
      for (const ClipId id : snapshot.clips())
        ASSERT_TRUE(reads_back(snapshot, id, *clips[static_cast<std::size_t>(id)])) << round;
      saved += static_cast<int>(report.clips);
    } catch (const Error& error) {
      ASSERT_TRUE(error.kind() == ErrorKind::kInput || error.kind() == ErrorKind::kDamaged) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(saved, 120);
  EXPECT_LT(refused, 40);
}

TEST_F(Rewrite, WhatIsNoStoreIsNotRepaired) {
  write_file(a_, std::vector<char>(100000, 'x'));
  write_file(b_, {});
  EXPECT_EQ(kind_of([&] { repair(a_, c_, kIndex); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { repair(b_, c_, kIndex); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { repair(folder_.path(), c_, kIndex); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { repair(folder_ / "none", c_, kIndex); }), ErrorKind::kInput);
  EXPECT_FALSE(fs::exists(c_));
}

}  // namespace
}  // namespace freshet::store
