#include "store/store.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <optional>
#include <random>
#include <thread>

#include "store/rewrite/rewrite.h"
#include "tests/store/clip_samples.h"

namespace freshet::store {
namespace {

TEST(Store, GivesBackClipsOfAnyShape) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a.freshet", "{\"patch\": 48}");
  std::vector<TestClip> clips;
  std::mt19937_64 random(7);
  for (std::uint64_t i = 0; i < 24; ++i) {
    TestClip clip;
    clip.name = "clip " + std::to_string(i);
    clip.seed = i;
    clip.frames = 1 + static_cast<std::uint32_t>(random() % 40);
    clip.rows = random() % 50;
    clip.planes.clear();
    for (std::uint64_t p = 0; p < 1 + random() % 3; ++p) {
      clip.planes.push_back({static_cast<std::uint32_t>(1 + random() % 150),
                             static_cast<std::uint32_t>(1 + random() % 90),
                             static_cast<std::uint8_t>(1 + random() % 2)});
    }
    if (i == 0) clip.planes = {{1, 77, 1}};
    if (i == 1) clip.planes = {{129, 1, 2}};
    EXPECT_EQ(add_clip(store, clip), ClipId{static_cast<std::uint32_t>(i)});
    clips.push_back(clip);
  }
  const Snapshot snapshot = store.snapshot();
  EXPECT_EQ(snapshot.settings(), "{\"patch\": 48}");
  ASSERT_EQ(snapshot.clips().size(), clips.size());
  for (std::uint32_t i = 0; i < clips.size(); ++i) {
    EXPECT_TRUE(reads_back(snapshot, ClipId{i}, clips[i])) << i;
    EXPECT_EQ(snapshot.find(clips[i].name), ClipId{i});
    EXPECT_EQ(snapshot.find_source("hash of " + clips[i].name), ClipId{i});
  }
  EXPECT_TRUE(snapshot.verify().empty());
}

TEST(Store, KeepsClipsWhenClosedAndOpenedAgain) {
  const ScratchFolder folder;
  const TestClip clip;
  {
    Store store = Store::create(folder / "a", "s");
    add_clip(store, clip);
  }
  const Store store = Store::open_read(folder / "a");
  EXPECT_TRUE(reads_back(store.snapshot(), ClipId{0}, clip));
  EXPECT_EQ(store.snapshot().clip(ClipId{0}).frame_count, clip.frames);
  EXPECT_EQ(store.snapshot().clip(ClipId{0}).rows, clip.rows);
}

// What is checked before a file is mapped must hold for whatever LMDB makes of a life of changes.
TEST(Store, IsFoundWholeAfterAnyChanges) {
  const ScratchFolder folder;
  std::mt19937_64 random(41);
  std::optional<Store> store = Store::create(folder / "a", "");
  std::uint64_t clips = 0;
  for (int round = 0; round < 240; ++round) {
    const std::uint64_t what = random() % 8;
    std::vector<std::byte> bytes(random() % 4 == 0 ? random() % 300000 : random() % 5000);
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    const std::string name(1 + random() % 40, static_cast<char>('a' + random() % 20));
    if (what == 0) {
      TestClip clip{
          .name = "clip " + std::to_string(clips), .frames = 3, .seed = clips, .rows = random() % 3000};
      ClipWriter writer = write_clip(*store, clip);
      ClipRecord record = clip.record();
      record.metadata = std::string(random() % 6000, 'm');
      if (random() % 3 != 0) {
        writer.commit(record);
        ++clips;
      }
    } else if (what < 3 && clips > 0) {
      const ClipId id{static_cast<std::uint32_t>(random() % clips)};
      const Store::Column column{id, name, bytes};
      store->write({}, {&column, 1});
    } else if (what == 3) {
      const std::vector<std::string> names = store->snapshot().blob_names();
      if (!names.empty()) store->write({}, {}, {&names[random() % names.size()], 1});
    } else if (what < 7) {
      const Store::Blob blob{name, bytes};
      store->write({&blob, 1});
    } else {
      const std::string digest = store->snapshot().digest();
      store.reset();
      if (random() % 4 == 0) compact(folder / "a");
      store = Store::open_write(folder / "a");
      ASSERT_EQ(store->snapshot().digest(), digest) << round;
    }
    const std::vector<std::string> faults = store->snapshot().verify();
    ASSERT_TRUE(faults.empty()) << round << ": " << faults.front();
  }
}

TEST(Store, KeepsBlobsOfAnySizeAndReplacesThem) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  std::mt19937_64 random(3);
  for (const std::size_t size : {0, 1, 1000, 1 << 20, (3 << 20) + 17}) {
    std::vector<std::byte> bytes(size);
    for (auto& byte : bytes) byte = static_cast<std::byte>(random() % 7);
    const Store::Blob blob{"codebook", bytes};
    store.write({&blob, 1});
    EXPECT_EQ(store.snapshot().blob("codebook"), bytes);
  }
  EXPECT_EQ(store.snapshot().blob_names(), std::vector<std::string>{"codebook"});
  EXPECT_FALSE(store.snapshot().blob("code").has_value());
  const std::string erased[] = {"codebook"};
  store.write({}, {}, erased);
  EXPECT_TRUE(store.snapshot().blob_names().empty());
}

TEST(Store, ReplacesAColumnOfACommittedClip) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  const ClipId id = add_clip(store, {.rows = 700000});
  std::vector<std::uint16_t> words(700000, 5);
  const Store::Column column{id, "patch.words", std::as_bytes(std::span(words)), 2};
  store.write({}, {&column, 1});
  EXPECT_EQ(store.snapshot().column<std::uint16_t>(id, "patch.words"), words);
  const Store::Column shorter{id, "patch.words", std::as_bytes(std::span(words).first(10)), 2};
  EXPECT_EQ(kind_of([&] { store.write({}, {&shorter, 1}); }), ErrorKind::kUsage);
  EXPECT_FALSE(store.snapshot().has_column(id, "patch.wor"));
  EXPECT_EQ(kind_of([&] { store.snapshot().column<float>(id, "patch.words"); }), ErrorKind::kUsage);
  EXPECT_EQ(kind_of([&] { store.snapshot().column<float>(id, "none"); }), ErrorKind::kNotFound);
}

/// Pages of a file that lie in the system's cache.
std::size_t cached_pages(const std::filesystem::path& file) {
  const std::size_t bytes = std::filesystem::file_size(file), pages = (bytes + 4095) / 4096;
  const int descriptor = ::open(file.c_str(), O_RDONLY);
  void* const at = mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor, 0);
  ::close(descriptor);
  std::vector<unsigned char> cached(pages);
  EXPECT_EQ(mincore(at, bytes, cached.data()), 0);
  munmap(at, bytes);
  return static_cast<std::size_t>(
      std::count_if(cached.begin(), cached.end(), [](unsigned char page) { return (page & 1) != 0; }));
}

TEST(Store, PrefetchesAColumnAndNothingBesideIt) {
  const ScratchFolder folder;
  constexpr std::size_t kRows = 1 << 20;
  {
    Store store = Store::create(folder / "a", "");
    TestClip clip;
    clip.rows = kRows;
    ClipWriter writer = write_clip(store, clip);
    std::mt19937 random(3);
    for (const char* name : {"wanted", "other"}) {
      std::vector<std::uint32_t> noise(kRows);
      for (std::uint32_t& value : noise) value = static_cast<std::uint32_t>(random());
      writer.column<std::uint32_t>(name, noise);
    }
    writer.commit(clip.record());
  }
  const int descriptor = ::open((folder / "a").c_str(), O_RDONLY);
  fsync(descriptor);
  posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  ::close(descriptor);
  const Snapshot snapshot = Store::open_read(folder / "a").snapshot();
  const std::size_t before = cached_pages(folder / "a"), column = kRows * 4 / 4096;
  if (before > column / 2) GTEST_SKIP() << "needs a disk: this file lies in memory";
  const ClipId clip = snapshot.clips()[0];
  snapshot.prefetch_column(clip, "no such column");
  snapshot.prefetch_column(clip, "wanted");
  // Some of the column's pages may have stayed in the cache.
  std::size_t cached = 0;
  for (int i = 0; i < 500 && cached < column; ++i) {
    usleep(10'000);
    cached = cached_pages(folder / "a");
  }
  EXPECT_GE(cached, column);
  EXPECT_LT(cached, before + column + column / 4);
}

TEST(Store, RefusesAClipItHas) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  add_clip(store, {});
  EXPECT_EQ(kind_of([&] { add_clip(store, {}); }), ErrorKind::kInput);
  EXPECT_EQ(store.snapshot().clips().size(), 1u);
}

TEST(Store, KnowsItsClipsWhateverWasWrittenBetween) {
  const ScratchFolder folder;
  std::optional<Store> store = Store::create(folder / "a", "");
  const auto refuses = [&](const std::string& name) {
    return kind_of([&] { add_clip(*store, {.name = name, .frames = 2}); }) == ErrorKind::kInput;
  };
  add_clip(*store, {.name = "a", .frames = 2});
  { const ClipWriter dropped = write_clip(*store, {.name = "b", .frames = 2}); }
  EXPECT_TRUE(refuses("a"));
  add_clip(*store, {.name = "b", .frames = 2});
  const std::byte byte{1};
  const Store::Blob blob{"blob", {&byte, 1}};
  store->write({&blob, 1});
  EXPECT_TRUE(refuses("a"));
  EXPECT_TRUE(refuses("b"));
  store.reset();
  store = Store::open_write(folder / "a");
  add_clip(*store, {.name = "c", .frames = 2});
  for (const char* name : {"a", "b", "c"}) EXPECT_TRUE(refuses(name)) << name;
  // The same source under another name, and another source under a known name.
  ClipRecord record = TestClip{.name = "d"}.record();
  record.source_hash = TestClip{.name = "b"}.record().source_hash;
  EXPECT_EQ(kind_of([&] { write_clip(*store, {.name = "d"}).commit(record); }), ErrorKind::kInput);
  record = TestClip{.name = "c"}.record();
  record.source_hash = "another";
  EXPECT_EQ(kind_of([&] { write_clip(*store, {.name = "c"}).commit(record); }), ErrorKind::kInput);
  EXPECT_EQ(store->snapshot().clips().size(), 3u);
}

TEST(Store, AClipWithoutCommitLeavesNoTrace) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  add_clip(store, {});
  const std::string digest = store.snapshot().digest();
  { const ClipWriter dropped = write_clip(store, {.name = "b", .seed = 2}); }
  EXPECT_EQ(store.snapshot().digest(), digest);
  EXPECT_TRUE(store.snapshot().verify().empty());
  EXPECT_EQ(add_clip(store, {.name = "b", .seed = 2}), ClipId{1});
}

TEST(Store, ReadersGoOnWhileAWriterCommits) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  const TestClip first;
  add_clip(store, first);
  const Snapshot before = store.snapshot();
  std::atomic<bool> done = false, whole = true;
  std::vector<std::thread> readers;
  for (int i = 0; i < 3; ++i) {
    readers.emplace_back([&] {
      while (!done) whole = whole && reads_back(before, ClipId{0}, first) && before.clips().size() == 1;
    });
  }
  for (std::uint64_t i = 1; i < 8; ++i) add_clip(store, {.name = std::to_string(i), .seed = i});
  done = true;
  for (std::thread& reader : readers) reader.join();
  EXPECT_TRUE(whole);
  EXPECT_EQ(before.clips().size(), 1u);
  EXPECT_EQ(store.snapshot().clips().size(), 8u);
}

TEST(Store, ReadsOfRegionsAgreeWithReadsOfWholePlanes) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a", "");
  const TestClip clip{.planes = {{200, 150, 1}, {100, 75, 1}}, .frames = 37};
  const ClipId id = add_clip(store, clip);
  const Snapshot snapshot = store.snapshot();
  std::mt19937_64 random(5);
  for (int i = 0; i < 200; ++i) {
    const auto p = static_cast<std::uint32_t>(random() % 2);
    const PlaneShape& size = clip.planes[p];
    const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
    Rect region{below(size.width), below(size.height), 0, 0};
    region.width = below(size.width - region.x + 1);
    region.height = below(size.height - region.y + 1);
    const std::uint32_t first = below(clip.frames), count = below(clip.frames - first + 1);
    Samples out(std::size_t{region.width} * region.height * count), expected;
    snapshot.read(id, Stream::kFrames, p, region, first, count, out);
    const Samples whole = clip.plane(p);
    for (std::uint32_t f = first; f < first + count; ++f) {
      for (std::uint32_t y = region.y; y < region.y + region.height; ++y) {
        const auto row = whole.begin() + (std::ptrdiff_t{f} * size.height + y) * size.width + region.x;
        expected.insert(expected.end(), row, row + region.width);
      }
    }
    ASSERT_EQ(out, expected);
  }
}

/// Samples of whole numbers alone: drifting ramps, and a generator's noise.
Samples whole_number_plane(const PlaneShape& shape, std::uint32_t frames, std::uint32_t seed) {
  Samples samples;
  std::uint32_t noise = seed;
  for (std::uint32_t f = 0; f < frames; ++f)
    for (std::uint32_t y = 0; y < shape.height; ++y)
      for (std::uint32_t x = 0; x < shape.width * shape.bytes_per_sample; ++x) {
        noise = noise * 1664525 + 1013904223;
        samples.push_back(static_cast<std::byte>(3 * x + 2 * y + 5 * f + (noise >> 29)));
      }
  return samples;
}

// The digest names a store's content wherever it was made: a clip of whole numbers has this one on every machine.
TEST(Store, DigestIsTheOneThatItWasOnOtherMachines) {
  const ScratchFolder folder;
  Store store = Store::create(folder / "a.store", R"({"settings": 1})");
  const TestClip clip;
  ClipWriter writer = store.add_clip();
  writer.begin_stream(Stream::kFrames, clip.planes);
  std::vector<Samples> planes;
  for (std::uint32_t p = 0; p < clip.planes.size(); ++p)
    planes.push_back(whole_number_plane(clip.planes[p], clip.frames, p));
  append_planes(writer, Stream::kFrames, clip.planes, planes, 0, clip.frames);
  const std::vector<PlaneShape> flow_shapes(2, clip.flow_shape());
  writer.begin_stream(Stream::kFlow, flow_shapes);
  const std::vector<Samples> flow{whole_number_plane(flow_shapes[0], clip.frames - 1, 10),
                                  whole_number_plane(flow_shapes[1], clip.frames - 1, 11)};
  append_planes(writer, Stream::kFlow, flow_shapes, flow, 0, clip.frames - 1);
  const std::vector<float> column = clip.column();
  writer.column<float>("patch.mean_u", column);
  writer.commit(clip.record());
  const Store::Blob blob{"codebook", std::as_bytes(std::span(column))};
  store.write({&blob, 1});
  EXPECT_EQ(store.snapshot().digest(), "d5f1dabc71fc28335b630d12c094eb08");
}

}  // namespace
}  // namespace freshet::store
