// What other processes, and people, do to a store that is open: grow it, die with it, move it, take it away.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <random>

#include "store/format/lmdb_layout.h"
#include "tests/harness/fault.h"
#include "tests/store/raw_file.h"

namespace freshet::store {
namespace {

TestClip numbered(std::uint64_t i) { return {.name = "clip " + std::to_string(i), .seed = i}; }

std::vector<std::byte> noise(std::size_t bytes, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::byte> out(bytes);
  for (std::size_t i = 0; i + 8 <= bytes; i += 8) {
    const std::uint64_t word = random();
    std::memcpy(&out[i], &word, 8);
  }
  return out;
}

void write_blob(Store& store, const std::string& name, const std::vector<std::byte>& bytes) {
  const Store::Blob blob{name, bytes, true};
  store.write({&blob, 1});
}

/// A process beside this one. It says when it has come to a point, and waits to be told to go on.
class Beside {
 public:
  template <class Act>
  explicit Beside(const Act& act) {
    if (pipe(said_) != 0 || pipe(told_) != 0) std::abort();
    child_ = fork();
    if (child_ != 0) return;
    int code = 99;
    try {
      code = act(*this);
    } catch (const Error& error) {
      code = 50 + static_cast<int>(error.kind());
    } catch (...) {
    }
    _exit(code);
  }
  // In the child.
  void say_and_wait() const {
    char c = 0;
    if (write(said_[1], &c, 1) != 1 || read(told_[0], &c, 1) != 1) _exit(98);
  }
  // In the parent.
  void hear() const {
    char c = 0;
    ASSERT_EQ(read(said_[0], &c, 1), 1);
  }
  void tell() const {
    char c = 0;
    ASSERT_EQ(write(told_[1], &c, 1), 1);
  }
  /// Its exit status, or -1 when a signal ended it.
  int end() const {
    int status = 0;
    waitpid(child_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  pid_t process() const { return child_; }

 private:
  int said_[2], told_[2];
  pid_t child_ = 0;
};

/// As `ulimit -v`: so many bytes more than are mapped now.
void limit_address_space(std::size_t more) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlim_t bytes = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + more;
  const rlimit limit{bytes, RLIM_INFINITY};
  setrlimit(RLIMIT_AS, &limit);
}

constexpr std::size_t kMiB = 1 << 20;

// The writer maps a terabyte; a reader that was to do the same was left without any map, and died.
TEST(Upheaval, AReaderInLittleAddressSpaceFollowsAStoreThatGrows) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  {
    Store store = Store::create(file, "");
    add_clip(store, numbered(0));
  }
  const auto blob = noise(90 * kMiB, 1);
  const Beside reader([&](const Beside& self) {
    limit_address_space(110 * kMiB);
    const Store store = Store::open_read(file);
    if (!reads_back(store.snapshot(), ClipId{0}, numbered(0))) return 1;
    self.say_and_wait();
    limit_address_space(400 * kMiB);
    const Snapshot grown = store.snapshot();
    return reads_back(grown, ClipId{0}, numbered(0)) && grown.blob("noise") == blob ? 0 : 2;
  });
  reader.hear();
  Store store = Store::open_write(file);
  write_blob(store, "noise", blob);
  reader.tell();
  EXPECT_EQ(reader.end(), 0);
}

TEST(Upheaval, AReaderThatCannotFollowSaysSo) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  {
    Store store = Store::create(file, "");
    add_clip(store, numbered(0));
  }
  const Beside reader([&](const Beside& self) {
    limit_address_space(110 * kMiB);
    const Store store = Store::open_read(file);
    self.say_and_wait();
    for (int i = 0; i < 2; ++i)
      if (kind_of([&] { store.snapshot(); }) != ErrorKind::kIo) return 1;
    return 0;
  });
  reader.hear();
  Store store = Store::open_write(file);
  write_blob(store, "noise", noise(200 * kMiB, 1));
  reader.tell();
  EXPECT_EQ(reader.end(), 0);
}

TEST(Upheaval, AWriterInLittleAddressSpaceStopsAndLeavesAWholeStore) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  {
    Store store = Store::create(file, "");
    add_clip(store, numbered(0));
  }
  const Beside writer([&](const Beside&) {
    limit_address_space(110 * kMiB);
    Store store = Store::open_write(file);
    for (int i = 0; i < 20; ++i) {
      const auto bytes = noise(10 * kMiB, static_cast<std::uint64_t>(i));
      if (kind_of([&] { write_blob(store, "noise" + std::to_string(i), bytes); }) == ErrorKind::kIo)
        return i > 1 ? 0 : 1;
    }
    return 2;
  });
  EXPECT_EQ(writer.end(), 0);
  const Store store = Store::open_read(file);
  EXPECT_TRUE(store.snapshot().verify().empty());
  EXPECT_GT(store.snapshot().blob_names().size(), 1u);
}

// Its pages were kept until the store was opened anew: with each change the file grew by what was changed.
TEST(Upheaval, AReaderThatDiedHoldsNothingBack) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  Store store = Store::create(file, "");
  const auto blob = noise(kMiB, 1);
  write_blob(store, "noise", blob);
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  setenv("FRESHET_TEST_STORE", file.c_str(), 1);
  const int code = std::system(
      (self + " --gtest_also_run_disabled_tests --gtest_filter=Reader.DISABLED_Dies" + " > /dev/null")
          .c_str());
  EXPECT_EQ(WEXITSTATUS(code), 128 + SIGKILL);
  for (std::uint64_t i = 0; i < 30; ++i) write_blob(store, "noise", noise(kMiB, i));
  EXPECT_LT(std::filesystem::file_size(file), 6 * kMiB);
  EXPECT_TRUE(store.snapshot().verify().empty());
}

// Run by the test above as a process of its own.
TEST(Reader, DISABLED_Dies) {
  const Store store = Store::open_read(std::getenv("FRESHET_TEST_STORE"));
  const Snapshot snapshot = store.snapshot();
  ASSERT_TRUE(snapshot.blob("noise"));
  raise(SIGKILL);
}

TEST(Upheaval, WhatIsMovedOrRemovedIsReadOnAndWrittenNoMore) {
  const ScratchFolder folder;
  for (const bool removed : {false, true}) {
    const auto file = folder / (removed ? "removed" : "moved"), other = folder / "other";
    Store store = Store::create(file, "");
    add_clip(store, numbered(0));
    const Snapshot snapshot = store.snapshot();
    {
      ClipWriter in_hand = store.add_clip();
      if (removed)
        std::filesystem::remove(file);
      else
        std::filesystem::rename(file, other);
      ClipRecord record;
      record.name = "in hand";
      EXPECT_EQ(kind_of([&] { in_hand.commit(record); }), ErrorKind::kIo);
    }
    EXPECT_EQ(kind_of([&] { add_clip(store, numbered(1)); }), ErrorKind::kIo);
    EXPECT_TRUE(reads_back(snapshot, ClipId{0}, numbered(0)));
    EXPECT_TRUE(reads_back(store.snapshot(), ClipId{0}, numbered(0)));
    if (removed) continue;
    std::filesystem::rename(other, file);
    add_clip(store, numbered(1));
    EXPECT_TRUE(store.snapshot().verify().empty());
  }
}

/// The store as if 200 GB had been written into it and given up: pages that nobody uses, and none of them on the disk.
void make_vast(const std::filesystem::path& file, std::uint64_t bytes) {
  constexpr std::uint64_t kPage = 4096;
  const std::uint64_t last_page = bytes / kPage - 1, map_bytes = bytes * 4;
  std::fstream stream(file, std::ios::binary | std::ios::in | std::ios::out);
  for (const std::uint64_t meta : {0, 1}) {
    stream.seekp(static_cast<std::streamoff>(meta * kPage + 32));
    stream.write(reinterpret_cast<const char*>(&map_bytes), 8);
    stream.seekp(static_cast<std::streamoff>(meta * kPage + 136));
    stream.write(reinterpret_cast<const char*>(&last_page), 8);
  }
  stream.close();
  std::filesystem::resize_file(file, bytes);
}

TEST(Upheaval, AStoreOf200GigabytesIsReadAndWrittenAsAnyOther) {
  const ScratchFolder folder;
  const auto file = folder / "a", small = folder / "b";
  std::string expected;
  for (const auto& path : {small, file}) {
    Store store = Store::create(path, "");
    add_clip(store, numbered(0));
  }
  {
    Store store = Store::open_write(small);
    for (std::uint64_t i = 1; i <= 3; ++i) add_clip(store, numbered(i));
    expected = store.snapshot().digest();
  }
  make_vast(file, 200'000'000'000 / 4096 * 4096);
  {
    const Store reader = Store::open_read(file);
    EXPECT_TRUE(reader.snapshot().verify().empty());
  }
  // Readers go on while it grows from there on.
  Store store = Store::open_write(file);
  const Snapshot before = store.snapshot();
  for (std::uint64_t i = 1; i <= 3; ++i) {
    add_clip(store, numbered(i));
    EXPECT_TRUE(reads_back(before, ClipId{0}, numbered(0)));
    EXPECT_TRUE(reads_back(store.snapshot(), ClipId{static_cast<std::uint32_t>(i)}, numbered(i)));
  }
  EXPECT_EQ(store.snapshot().digest(), expected);
  EXPECT_TRUE(store.snapshot().verify().empty());
  EXPECT_GT(std::filesystem::file_size(file), 200'000'000'000u);
  struct stat status {};
  ASSERT_EQ(stat(file.c_str(), &status), 0);
  EXPECT_LT(status.st_blocks * 512, 100 << 20) << "on the disk";
}

/// Replaces what there is, so that freed pages are used again.
void write_much(const std::filesystem::path& file) {
  Store store = Store::open_write(file);
  for (std::uint64_t i = 0; i < 6; ++i) write_blob(store, "noise", noise(2 * kMiB, 10 + i));
}

// LMDB leaves a list of free pages that became shorter while it was written on pages of its own.
TEST(Upheaval, AStoreWhoseFreePagesWereUsedAgainIsOpened) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  Store::create(file, "");
  {
    Store store = Store::open_write(file);
    write_blob(store, "noise", noise(2 * kMiB, 1));
    write_blob(store, "other", noise(2 * kMiB, 2));
  }
  for (int run = 0; run < 6; ++run) {
    write_much(file);
    const std::vector<std::string> faults = Store::open_read(file).snapshot().verify();
    ASSERT_TRUE(faults.empty()) << run << ": " << faults.front();
  }
}

/// A store of a clip and a blob, which a process beside this one reads in the midst of what `upheaval` does to it.
/// Returns its exit status: 0 when it read what was there when it began.
int read_across(const std::filesystem::path& file, const std::filesystem::path& name,
                const std::function<void()>& upheaval) {
  const auto blob = noise(2 * kMiB, 1);
  {
    Store store = Store::create(file, "");
    add_clip(store, numbered(0));
    write_blob(store, "noise", blob);
    write_blob(store, "other", noise(2 * kMiB, 2));
  }
  const Beside reader([&](const Beside& self) {
    const Store store = Store::open_read(name);
    const Snapshot snapshot = store.snapshot();
    self.say_and_wait();
    return snapshot.verify().empty() && reads_back(snapshot, ClipId{0}, numbered(0)) &&
                   snapshot.blob("noise") == blob
               ? 0
               : 1;
  });
  reader.hear();
  upheaval();
  reader.tell();
  return reader.end();
}

void expect_refused(const std::function<void()>& act) {
  const std::string fault = fault_of(ErrorKind::kIo, [&] { act(); });
  EXPECT_NE(fault.find("another name"), std::string::npos) << fault;
}

// LMDB's table of readers is in a file beside the store, by the store's name.
TEST(Upheaval, AReaderByASymbolicLinkKeepsItsPages) {
  const ScratchFolder folder;
  const auto file = folder / "a", link = folder / "link";
  std::filesystem::create_symlink("a", link);
  EXPECT_EQ(read_across(file, link, [&] { write_much(file); }), 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "link-lock"));
}

TEST(Upheaval, AWriterByAHardLinkWaitsForReadersByAnother) {
  const ScratchFolder folder;
  const auto file = folder / "a", link = folder / "link";
  Store::create(file, "");
  std::filesystem::create_hard_link(file, link);
  {
    Store store = Store::open_write(file);
    write_blob(store, "noise", noise(2 * kMiB, 1));
    write_blob(store, "other", noise(2 * kMiB, 2));
  }
  const Beside reader([&](const Beside& self) {
    const Store store = Store::open_read(link);
    const Snapshot snapshot = store.snapshot();
    self.say_and_wait();
    return snapshot.blob("noise") == noise(2 * kMiB, 1) ? 0 : 1;
  });
  reader.hear();
  expect_refused([&] { write_much(file); });
  write_much(link);  // by its own name the reader is seen
  reader.tell();
  EXPECT_EQ(reader.end(), 0);
  write_much(file);
}

TEST(Upheaval, AReaderByAHardLinkWaitsForAWriterByAnother) {
  const ScratchFolder folder;
  const auto file = folder / "a", link = folder / "link";
  Store::create(file, "");
  std::filesystem::create_hard_link(file, link);
  const Beside writer([&](const Beside& self) {
    Store store = Store::open_write(file);
    self.say_and_wait();
    write_blob(store, "noise", noise(kMiB, 1));
    return 0;
  });
  writer.hear();
  expect_refused([&] { Store::open_read(link); });
  { const Store store = Store::open_read(file); }
  writer.tell();
  EXPECT_EQ(writer.end(), 0);
  EXPECT_EQ(Store::open_read(link).snapshot().blob("noise"), noise(kMiB, 1));
}

TEST(Upheaval, AReaderWhoseLockFileWasRemovedKeepsItsPages) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  EXPECT_EQ(read_across(file, file,
                        [&] {
                          std::filesystem::remove(folder / "a-lock");
                          expect_refused([&] { write_much(file); });
                        }),
            0);
  write_much(file);
  EXPECT_TRUE(Store::open_read(file).snapshot().verify().empty());
}

}  // namespace
}  // namespace freshet::store
