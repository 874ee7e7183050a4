// What survives a kill, a full disk, missing permissions, and any number of threads.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <xxhash.h>

#include <csignal>
#include <random>

#include "tests/store/raw_file.h"

namespace freshet::store {
namespace {

/// Runs `act` in a child; its exit status, or -1 when a signal ended it.
template <class Act>
int in_child(const Act& act) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 99;
    try {
      code = act();
    } catch (const Error& error) {
      code = 50 + static_cast<int>(error.kind());
    } catch (...) {
    }
    _exit(code);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TestClip numbered(std::uint64_t i) { return {.name = "clip " + std::to_string(i), .seed = i}; }

TEST(Durability, AKilledWriterLeavesTheClipsWhoseCommitReturned) {
  const ScratchFolder folder;
  for (unsigned delay_ms : {5, 15, 30, 60, 90}) {
    const auto file = folder / ("a" + std::to_string(delay_ms));
    Store::create(file, "");
    int pipe_ends[2];
    ASSERT_EQ(pipe(pipe_ends), 0);
    const pid_t child = fork();
    if (child == 0) {
      Store store = Store::open_write(file);
      for (std::uint64_t i = 0;; ++i) {
        add_clip(store, numbered(i));
        const char one = 1;
        if (write(pipe_ends[1], &one, 1) != 1) _exit(1);
      }
    }
    usleep(delay_ms * 1000);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(pipe_ends[1]);
    std::size_t returned = 0;
    for (char one; read(pipe_ends[0], &one, 1) == 1;) ++returned;
    close(pipe_ends[0]);

    Store store = Store::open_write(file);
    const Snapshot snapshot = store.snapshot();
    // The last commit may have reached the disk before it could be told.
    EXPECT_GE(snapshot.clips().size(), returned);
    EXPECT_LE(snapshot.clips().size(), returned + 1);
    EXPECT_TRUE(snapshot.verify().empty());
    for (std::uint32_t i = 0; i < snapshot.clips().size(); ++i)
      EXPECT_TRUE(reads_back(snapshot, ClipId{i}, numbered(i)));
    add_clip(store, {.name = "after", .seed = 1000});
  }
}

TEST(Durability, AFullDiskLeavesTheStoreAsItWas) {
  const ScratchFolder folder;
  {
    Store store = Store::create(folder / "a", "");
    add_clip(store, numbered(0));
  }
  const std::string digest = Store::open_read(folder / "a").snapshot().digest();
  const auto bytes = std::filesystem::file_size(folder / "a");
  const int code = in_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes + 30000, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    Store store = Store::open_write(folder / "a");
    try {
      TestClip big = numbered(2);
      big.planes = {{400, 300, 1}};
      add_clip(store, big);
      return 1;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kIo) return 2;
      if (std::string(error.what()).find("free space") == std::string::npos) return 3;
    }
    if (store.snapshot().digest() != digest) return 4;
    // With room again, the same writer takes the clip that it could not commit.
    const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &none);
    add_clip(store, numbered(2));
    return store.snapshot().clips().size() == 2 ? 0 : 5;
  });
  EXPECT_EQ(code, 0);
  Store store = Store::open_write(folder / "a");
  EXPECT_EQ(store.snapshot().clips().size(), 2u);
  EXPECT_TRUE(store.snapshot().verify().empty());
  add_clip(store, numbered(1));
}

// A clip's columns of 16 MB that no compression makes smaller.
std::vector<std::uint64_t> noise_of_16_mb() {
  std::vector<std::uint64_t> noise(std::size_t{2} << 20);
  std::mt19937_64 random(1);
  for (std::uint64_t& value : noise) value = random();
  return noise;
}
ClipWriter write_large_clip(Store& store, const std::vector<std::uint64_t>& noise, int columns) {
  ClipWriter writer = write_clip(store, numbered(7));
  for (int i = 0; i < columns; ++i)
    writer.column<std::uint64_t>("noise " + std::to_string(i), std::span(noise));
  return writer;
}

TEST(Durability, ALargeClipIsWrittenBeforeItsCommitAndNotKeptInMemory) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  add_clip(store, numbered(0));
  const std::string digest = store.snapshot().digest();
  const auto before = std::filesystem::file_size(folder / "a");
  const std::vector<std::uint64_t> noise = noise_of_16_mb();
  {
    const ClipWriter dropped = write_large_clip(store, noise, 10);
    EXPECT_GT(std::filesystem::file_size(folder / "a"), before + (std::uintmax_t{90} << 20));
    // Nothing leads to what is written.
    EXPECT_EQ(store.snapshot().digest(), digest);
    EXPECT_TRUE(store.snapshot().verify().empty());
  }
  // And it goes with the clip.
  EXPECT_LE(std::filesystem::file_size(folder / "a"), before);
  EXPECT_EQ(store.snapshot().digest(), digest);

  write_large_clip(store, noise, 10).commit(numbered(7).record());
  const Snapshot snapshot = store.snapshot();
  EXPECT_TRUE(snapshot.verify().empty());
  EXPECT_EQ(snapshot.column<std::uint64_t>(ClipId{1}, "noise 3"), noise);
  EXPECT_TRUE(reads_back(snapshot, ClipId{0}, numbered(0)));
}

TEST(Durability, ADiskThatIsFullBeforeALargeClipsCommitLeavesTheStoreAsItWas) {
  const ScratchFolder folder;
  {
    Store store = Store::create(folder / "a", "");
    add_clip(store, numbered(0));
  }
  const auto before = std::filesystem::file_size(folder / "a");
  const int code = in_child([&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{before + (rlim_t{100} << 20), RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    Store store = Store::open_write(folder / "a");
    try {
      write_large_clip(store, noise_of_16_mb(), 10);
      return 1;
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kIo) return 2;
    }
    if (std::filesystem::file_size(folder / "a") > before) return 3;
    add_clip(store, numbered(1));
    return 0;
  });
  EXPECT_EQ(code, 0);
  const Snapshot snapshot = Store::open_read(folder / "a").snapshot();
  EXPECT_EQ(snapshot.clips().size(), 2u);
  EXPECT_TRUE(snapshot.verify().empty());
}

TEST(Durability, AFileThatCannotBeWrittenInAFolderThatCannotCanBeRead) {
  const ScratchFolder folder;
  const auto sealed = folder / "sealed", file = sealed / "a";
  std::filesystem::create_directory(sealed);
  {
    Store store = Store::create(file, "");
    add_clip(store, numbered(0));
  }
  std::filesystem::remove(file.string() + "-lock");
  chmod(file.c_str(), 0444);
  chmod(sealed.c_str(), 0555);
  chmod(folder.path().c_str(), 0755);
  const int code = in_child([&] {
    if (geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0)) return 7;
    const bool refused = kind_of([&] { Store::open_write(file); }) == ErrorKind::kIo;
    const Store store = Store::open_read(file);
    return refused && reads_back(store.snapshot(), ClipId{0}, numbered(0)) ? 0 : 1;
  });
  chmod(sealed.c_str(), 0755);
  EXPECT_EQ(code, 0);
  EXPECT_FALSE(std::filesystem::exists(file.string() + "-lock"));
}

TEST(Durability, AStoreIsNeverStandardErrorWhereThatIsClosed) {
  const ScratchFolder folder;
  const int code = in_child([&] {
    close(STDERR_FILENO);
    Store store = Store::create(folder / "a", "");
    add_clip(store, numbered(0));
    // A library of the host program says something.
    if (write(STDERR_FILENO, "a message\n", 10) == 10) return 1;
    return store.snapshot().verify().empty() &&
                   Store::open_read(folder / "a").snapshot().digest().size() == 32
               ? 0
               : 2;
  });
  EXPECT_EQ(code, 0);
  EXPECT_EQ(Store::open_read(folder / "a").snapshot().clips().size(), 1u);
}

TEST(Durability, OneWriterAtATimeAndReadersInOtherProcesses) {
  const ScratchFolder folder;
  const auto file = folder / "a";
  Store store = Store::create(file, "");
  add_clip(store, numbered(0));
  EXPECT_EQ(kind_of([&] { Store::open_write(file); }), ErrorKind::kIo);
  EXPECT_EQ(Store::open_read(file).snapshot().clips().size(), 1u);
  EXPECT_EQ(in_child([&] {
              // A child of fork must not use its parent's store; it opens its own through another name.
              std::filesystem::create_hard_link(file, folder / "b");
              return 0;
            }),
            0);
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string reader =
      self + " --gtest_also_run_disabled_tests --gtest_filter=Child.DISABLED_Reads > /dev/null";
  setenv("FRESHET_TEST_STORE", file.c_str(), 1);
  EXPECT_EQ(std::system(reader.c_str()), 0);
  EXPECT_EQ(kind_of([&] {
              ClipWriter first = store.add_clip();
              ClipWriter second = store.add_clip();
            }),
            ErrorKind::kUsage);
}

// Run by the test above as a process of its own.
TEST(Child, DISABLED_Reads) {
  const char* file = std::getenv("FRESHET_TEST_STORE");
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(Store::open_read(file).snapshot().clips().size(), 1u);
  EXPECT_EQ(kind_of([&] { Store::open_write(file); }), ErrorKind::kIo);
}

/// Equal for equal records: the store's id is given, and hashes depend on nothing else.
constexpr std::uint64_t kStoreId = 42;

std::uint64_t hash_of_records(const std::filesystem::path& file) {
  std::uint64_t hash = 0;
  const auto take = [&hash](const std::string& bytes) {
    hash = XXH3_64bits_withSeed(bytes.data(), bytes.size(), hash);
  };
  each_record(file, [&](const std::string& table, const std::string& key, std::string& value) {
    take(table);
    take(key);
    take(value);
    return false;
  });
  return hash;
}

TEST(Durability, TheFileIsTheSameForAnyNumberOfThreads) {
  const ScratchFolder folder;
  std::vector<std::uint64_t> hashes;
  for (const std::size_t threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto file = folder / std::to_string(threads);
    {
      Store store = Store::create(file, "{}", kStoreId);
      add_clip(store, {.planes = {{300, 200, 1}, {150, 100, 1}}, .frames = 33});
      add_clip(store, numbered(2));
    }
    hashes.push_back(hash_of_records(file));
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(Durability, TheDigestDoesNotDependOnTheOrderOfClips) {
  const ScratchFolder folder;
  std::string digests[2];
  for (int i = 0; i < 2; ++i) {
    Store store = Store::create(folder / std::to_string(i), "{}");
    add_clip(store, numbered(static_cast<std::uint64_t>(i)));
    add_clip(store, numbered(static_cast<std::uint64_t>(1 - i)));
    digests[i] = store.snapshot().digest();
    if (i == 0) {
      const std::vector<std::byte> bytes(9);
      const Store::Blob outside{"flann", bytes, false}, inside{"codebook", bytes};
      store.write({&outside, 1});
      EXPECT_EQ(store.snapshot().digest(), digests[0]);
      store.write({&inside, 1});
      EXPECT_NE(store.snapshot().digest(), digests[0]);
    }
  }
  EXPECT_EQ(digests[0], digests[1]);
}

// The bytes of the format. A change here is a change of the format: raise kFormatVersion. zstd's own bytes
// may change with its version; these are of 1.5.4.
TEST(Format, BytesArePinned) {
  const ScratchFolder folder;
  std::string digest;
  {
    Store store = Store::create(folder / "a", "{\"patch\":48}", kStoreId);
    ClipWriter writer = store.add_clip();
    // No floating point: the same samples on every machine.
    const std::vector<PlaneShape> planes = {{70, 40, 1}, {35, 20, 2}};
    std::vector<Samples> samples(2);
    for (unsigned i = 0; i < 70 * 40 * 18; ++i)
      samples[0].push_back(static_cast<std::byte>(i * i / 977 + i % 5));
    for (unsigned i = 0; i < 35 * 20 * 18 * 2; ++i)
      samples[1].push_back(static_cast<std::byte>(i % 2 == 0 ? i / 7 : i / 9000));
    writer.begin_stream(Stream::kFrames, planes);
    append_planes(writer, Stream::kFrames, planes, samples, 0, 18);
    std::vector<std::uint32_t> words(100);
    for (unsigned i = 0; i < 100; ++i) words[i] = i * i;
    writer.column<std::uint32_t>("patch.words", words);
    ClipRecord record;
    record.name = "a.mp4";
    record.source_hash = "0123456789abcdef0123456789abcdef";
    record.width = 70;
    record.height = 40;
    writer.commit(record);
    digest = store.snapshot().digest();
  }
  EXPECT_EQ(digest, "b4c3b0d53959a9059483fc65265155cd");
  EXPECT_EQ(hash_of_records(folder / "a"), 1549945356519814468u);
}

}  // namespace
}  // namespace freshet::store
