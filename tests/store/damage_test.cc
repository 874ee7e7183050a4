// What a flipped bit, a cut file or a record in the wrong place does: an error or nothing, never other data.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "tests/store/raw_file.h"

#include "tests/harness/fault.h"

namespace freshet::store {
namespace {

const TestClip kClip{.planes = {{70, 50, 1}, {35, 25, 1}}, .frames = 18};

void make_store(const std::filesystem::path& file) {
  Store store = Store::create(file, "settings of the store");
  add_clip(store, kClip);
  const std::vector<float> values(300, 2.5f);
  const Store::Blob blob{"codebook", std::as_bytes(std::span(values))};
  store.write({&blob, 1});
}

// Opens and reads everything there is. True when something was said to be wrong or all was as written; false
// when other data came out.
bool honest(const std::filesystem::path& file, const std::string& digest) {
  try {
    const Store store = Store::open_read(file);
    const Snapshot snapshot = store.snapshot();
    const bool whole = snapshot.verify().empty();
    if (snapshot.digest() != digest) return !whole && snapshot.clips().size() != 1;
    return true;
  } catch (const Error& error) {
    return error.kind() == ErrorKind::kDamaged || error.kind() == ErrorKind::kInput ||
           error.kind() == ErrorKind::kNotFound;
  }
}

// The same in a process of its own: a crash is an answer too, and a wrong one.
bool honest_apart(const std::filesystem::path& file, const std::string& digest) {
  const pid_t child = fork();
  if (child == 0) _exit(honest(file, digest) ? 0 : 1);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// What verify says of a store, in a process of its own; and that digest gives no other than the true one.
bool noticed_apart(const std::filesystem::path& file, const std::string& digest) {
  const pid_t child = fork();
  if (child == 0) {
    bool noticed = false, wrong = false;
    try {
      const Snapshot snapshot = Store::open_read(file).snapshot();
      noticed = !snapshot.verify().empty() && !snapshot.check_account().empty();
      wrong = snapshot.digest() == digest;  // it is damaged: there is no digest to give
    } catch (const Error& error) {
      noticed = noticed || error.kind() == ErrorKind::kDamaged || error.kind() == ErrorKind::kInput;
    }
    _exit(noticed && !wrong ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

class Damage : public testing::Test {
 protected:
  void SetUp() override {
    make_store(file_);
    digest_ = Store::open_read(file_).snapshot().digest();
    whole_ = file_bytes(file_);
  }
  const ScratchFolder folder_;
  const std::filesystem::path file_ = folder_ / "a", copy_ = folder_ / "b";
  std::string digest_;
  std::vector<char> whole_;
};

TEST_F(Damage, FlippedBitsAnywhereInTheFileNeverGiveOtherData) {
  std::mt19937_64 random(17);
  for (int i = 0; i < 1500; ++i) {
    std::vector<char> bytes = whole_;
    bytes[random() % bytes.size()] ^= static_cast<char>(1u << random() % 8);
    write_file(copy_, bytes);
    ASSERT_TRUE(honest_apart(copy_, digest_)) << i;
  }
}

TEST_F(Damage, FlippedBitsInThePagesOfKeysNeverCrash) {
  std::mt19937_64 random(19);
  std::vector<std::size_t> pages;  // branch, leaf and meta pages
  for (std::size_t at = 0; at + 4096 <= whole_.size(); at += 4096) {
    std::uint64_t number = 0;
    std::memcpy(&number, &whole_[at], 8);
    if (number == at / 4096 && (whole_[at + 10] & 11) != 0) pages.push_back(at);
  }
  ASSERT_GT(pages.size(), 3u);
  for (int i = 0; i < 1500; ++i) {
    std::vector<char> bytes = whole_;
    // Headers, pointers and nodes lie at both ends of a page.
    const std::size_t inside = random() % 2 == 0 ? random() % 200 : 4096 - 1 - random() % 600;
    bytes[pages[random() % pages.size()] + inside] ^= static_cast<char>(1u << random() % 8);
    write_file(copy_, bytes);
    ASSERT_TRUE(honest_apart(copy_, digest_)) << i;
  }
}

TEST_F(Damage, FlippedBitsInRecordsAreFoundByVerify) {
  std::mt19937_64 random(23);
  for (int i = 0; i < 300; ++i) {
    write_file(copy_, whole_);
    std::size_t target = random() % 8, seen = 0;
    bool hit = false;
    each_record(copy_, [&](const std::string& table, const std::string& key, std::string& value) {
      if (table == "meta" && key == "store") return false;
      if (seen++ != target) return false;
      hit = true;
      value[random() % value.size()] ^= static_cast<char>(1u << random() % 8);
      return true;
    });
    if (!hit) continue;
    bool found = false;
    try {
      found = !Store::open_read(copy_).snapshot().verify().empty();
    } catch (const Error& error) {
      found = error.kind() == ErrorKind::kDamaged;
    }
    ASSERT_TRUE(found) << target;
  }
}

TEST_F(Damage, CutFilesAreRefused) {
  std::mt19937_64 random(29);
  for (int i = 0; i < 200; ++i) {
    std::vector<char> bytes = whole_;
    bytes.resize(i < 20 ? static_cast<std::size_t>(i) * 17 : random() % bytes.size());
    write_file(copy_, bytes);
    ASSERT_TRUE(honest_apart(copy_, digest_)) << bytes.size();
  }
}

TEST_F(Damage, ARecordInAnothersPlaceIsFoundOut) {
  write_file(copy_, whole_);
  std::string frames;
  each_record(copy_, [&](const std::string& table, const std::string& key, std::string& value) {
    if (table != "tiles") return false;
    if (key[4] == 0) frames = value;
    if (key[4] == 1) value = frames;
    return key[4] == 1;
  });
  const Store store = Store::open_read(copy_);
  EXPECT_EQ(kind_of([&] { read_plane(store.snapshot(), ClipId{0}, Stream::kFlow, 0); }), ErrorKind::kDamaged);
  EXPECT_FALSE(store.snapshot().verify().empty());
}

// LMDB believes the flags of pages, entries and trees. Each bit of each, in every page of keys.
TEST_F(Damage, AFlagThatLmdbWouldNotSetIsFoundBeforeTheFileIsMapped) {
  const auto number_at = [&](std::size_t at) {
    std::uint16_t number = 0;
    std::memcpy(&number, &whole_[at], 2);
    return number;
  };
  std::vector<std::size_t> flags{4096 * 0 + 44, 4096 * 0 + 92, 4096 * 1 + 44, 4096 * 1 + 92};  // of trees
  for (std::size_t at = 0; at + 4096 <= whole_.size(); at += 4096) {
    std::uint64_t number = 0;
    std::memcpy(&number, &whole_[at], 8);
    const bool leaf = number == at / 4096 && number_at(at + 10) == 2;
    if (number == at / 4096 && number_at(at + 10) < 16) flags.push_back(at + 10);
    for (std::size_t i = at + 16; leaf && i < at + number_at(at + 12); i += 2) {
      const std::size_t node = at + number_at(i);
      flags.push_back(node + 4);
      if (number_at(node + 4) == 2) flags.push_back(node + 8 + number_at(node + 6) + 4);  // a table's tree
    }
  }
  ASSERT_GT(flags.size(), 30u);
  std::size_t noticed = 0;
  for (const std::size_t at : flags)
    for (int bit = 0; bit < 16; ++bit) {
      std::vector<char> bytes = whole_;
      bytes[at + bit / 8] = static_cast<char>(bytes[at + bit / 8] ^ (1 << bit % 8));
      write_file(copy_, bytes);
      const bool found = noticed_apart(copy_, digest_);
      ASSERT_TRUE(found || honest_apart(copy_, digest_))
          << "page " << at / 4096 << ", byte " << at % 4096 << ", bit " << bit;
      noticed += found ? 1 : 0;
    }
  // The others lie in pages that are free, or in the meta page of the state before.
  EXPECT_GE(noticed, 16 * flags.size() / 3);
}

// What a writer would allocate, were it believed.
TEST_F(Damage, APageThatIsFreeAndInUseIsFoundOut) {
  {
    Store store = Store::open_write(file_);
    store.write({}, {}, std::vector<std::string>{"codebook"});
    add_clip(store, {.name = "second", .seed = 9});
    digest_ = store.snapshot().digest();
  }
  whole_ = file_bytes(file_);
  const auto number_at = [&](const std::vector<char>& bytes, std::size_t at) {
    std::uint64_t number = 0;
    std::memcpy(&number, &bytes[at], 8);
    return number;
  };
  const std::size_t meta = number_at(whole_, 144) > number_at(whole_, 4096 + 144) ? 0 : 4096;
  const std::size_t free_root = number_at(whole_, meta + 80), main_root = number_at(whole_, meta + 128);
  ASSERT_LT(free_root, whole_.size() / 4096);
  std::uint16_t node = 0, key_bytes = 0;
  std::memcpy(&node, &whole_[free_root * 4096 + 16], 2);
  std::memcpy(&key_bytes, &whole_[free_root * 4096 + node + 6], 2);
  const std::size_t list = free_root * 4096 + node + 8 + key_bytes;
  ASSERT_GE(number_at(whole_, list), 1u);
  std::vector<char> bytes = whole_;
  std::memcpy(&bytes[list], "\1\0\0\0\0\0\0", 8);
  std::memcpy(&bytes[list + 8], &main_root, 8);
  write_file(copy_, bytes);
  EXPECT_EQ(kind_of([&] { Store::open_write(copy_); }), ErrorKind::kDamaged);
}

struct RawRecord {
  std::string table, key, value;
};

std::vector<RawRecord> records_of(const std::filesystem::path& file) {
  std::vector<RawRecord> records;
  each_record(file, [&](const std::string& table, const std::string& key, std::string& value) {
    records.push_back({table, key, value});
    return false;
  });
  return records;
}

// The pages stay as LMDB makes them: the records themselves must tell.
TEST_F(Damage, ARecordUnderAKeyWithOneOtherBitIsFoundOut) {
  std::mt19937_64 random(31);
  for (const RawRecord& record : records_of(file_)) {
    const std::size_t bits = 8 * record.key.size();
    const bool every = record.table == "columns" || record.table == "clips";
    for (std::size_t i = 0; i < (every ? bits : 12); ++i) {
      const std::size_t bit = every ? i : random() % bits;
      std::string key = record.key;
      key[bit / 8] = static_cast<char>(key[bit / 8] ^ (1 << bit % 8));
      write_file(copy_, whole_);
      edit_table(copy_, record.table.c_str(), [&](MDB_txn* txn, MDB_dbi dbi) {
        erase_raw(txn, dbi, record.key);
        put_raw(txn, dbi, key, record.value);
      });
      ASSERT_TRUE(noticed_apart(copy_, digest_)) << record.table << ", key " << record.key << ", bit " << bit;
    }
  }
}

// What info prints of a record's raw bytes stands in its header, whose hash it does not compute.
TEST_F(Damage, ARawSizeWithOneOtherBitIsFoundOutWithoutReadingPayloads) {
  for (const RawRecord& record : records_of(file_)) {
    if (record.table != "tiles" && record.table != "columns" && record.table != "blobs") continue;
    for (std::size_t bit = 0; bit < 64; ++bit) {
      std::string value = record.value;
      value[16 + bit / 8] = static_cast<char>(value[16 + bit / 8] ^ (1 << bit % 8));
      write_file(copy_, whole_);
      edit_table(copy_, record.table.c_str(),
                 [&](MDB_txn* txn, MDB_dbi dbi) { put_raw(txn, dbi, record.key, value); });
      ASSERT_FALSE(Store::open_read(copy_).snapshot().check_account().empty())
          << record.table << ", key " << record.key << ", bit " << bit;
    }
  }
}

TEST_F(Damage, ARecordThatIsLostIsFoundOut) {
  for (const RawRecord& record : records_of(file_)) {
    write_file(copy_, whole_);
    edit_table(copy_, record.table.c_str(),
               [&](MDB_txn* txn, MDB_dbi dbi) { erase_raw(txn, dbi, record.key); });
    ASSERT_TRUE(noticed_apart(copy_, digest_)) << record.table << ", key " << record.key;
  }
}

TEST_F(Damage, AColumnOrBlobAsItOnceWasIsFoundOut) {
  const std::vector<RawRecord> before = records_of(file_);
  {
    Store store = Store::open_write(file_);
    const std::vector<float> values(kClip.rows, 7.f), book(300, 1.5f);
    const Store::Column column{ClipId{0}, "patch.mean_u", std::as_bytes(std::span(values)), 4};
    const Store::Blob blob{"codebook", std::as_bytes(std::span(book))};
    store.write({&blob, 1}, {&column, 1});
    EXPECT_TRUE(store.snapshot().verify().empty());
    digest_ = store.snapshot().digest();
  }
  const std::vector<char> now = file_bytes(file_);
  for (const RawRecord& old : before) {
    if (old.table != "columns" && old.table != "blobs") continue;
    write_file(copy_, now);
    edit_table(copy_, old.table.c_str(),
               [&](MDB_txn* txn, MDB_dbi dbi) { put_raw(txn, dbi, old.key, old.value); });
    EXPECT_TRUE(noticed_apart(copy_, digest_)) << old.table;
  }
}

TEST_F(Damage, ARecordThatNobodyWroteIsFoundOut) {
  const std::vector<std::pair<std::string, std::string>> strays{
      {"meta", "sort"},
      {"tiles", std::string("\0\0\0\7\0\0\0\0\0", 9)},
      {"columns", std::string("\0\0\0\0patch.mean_v\0\0\0\0\0", 21)},
      {"blobs", std::string("codebooks\0\0\0\0\0", 14)}};
  for (const auto& [table, key] : strays) {
    write_file(copy_, whole_);
    std::string value;
    for (const RawRecord& record : records_of(file_))
      if (record.table == table) value = record.value;
    edit_table(copy_, table.c_str(), [&](MDB_txn* txn, MDB_dbi dbi) { put_raw(txn, dbi, key, value); });
    EXPECT_TRUE(noticed_apart(copy_, digest_)) << table;
  }
}

// The tiles that a read does not touch may be damaged: it does not decode them.
TEST_F(Damage, AReadDecodesOnlyTheTilesItTouches) {
  write_file(copy_, whole_);
  each_record(copy_, [](const std::string& table, const std::string& key, std::string& value) {
    if (table != "tiles" || key[4] != 0) return false;
    value.back() ^= 1;  // the last tile: chroma, frames 16 to 18
    return true;
  });
  const Store store = Store::open_read(copy_);
  Samples out(20 * 20 * 16);
  EXPECT_NO_THROW(store.snapshot().read(ClipId{0}, Stream::kFrames, 0, {10, 10, 20, 20}, 0, 16, out));
  Samples last(5 * 20 * 2);
  EXPECT_EQ(kind_of([&] {
              store.snapshot().read(ClipId{0}, Stream::kFrames, 1, {30, 5, 5, 20}, 16, 2, last);
            }),
            ErrorKind::kDamaged);
}

TEST(Open, OtherFilesAreNoStores) {
  const ScratchFolder folder;
  write_file(folder / "text", std::vector<char>(10000, 'x'));
  write_file(folder / "empty", {});
  EXPECT_EQ(kind_of([&] { Store::open_read(folder / "text"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { Store::open_read(folder / "empty"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { Store::open_read(folder / "none"); }), ErrorKind::kInput);
  EXPECT_EQ(kind_of([&] { Store::open_read(folder.path()); }), ErrorKind::kInput);

  MDB_env* env = nullptr;
  MDB_txn* txn = nullptr;
  MDB_dbi dbi = 0;
  mdb_env_create(&env);
  ASSERT_EQ(mdb_env_open(env, (folder / "other").c_str(), MDB_NOSUBDIR, 0666), 0);
  ASSERT_EQ(mdb_txn_begin(env, nullptr, 0, &txn), 0);
  ASSERT_EQ(mdb_dbi_open(txn, nullptr, 0, &dbi), 0);
  MDB_val key{4, const_cast<char*>("meta")}, value{3, const_cast<char*>("abc")};
  ASSERT_EQ(mdb_put(txn, dbi, &key, &value, 0), 0);
  ASSERT_EQ(mdb_txn_commit(txn), 0);
  mdb_env_close(env);
  EXPECT_EQ(kind_of([&] { Store::open_read(folder / "other"); }), ErrorKind::kInput);
}

TEST(Open, AnotherFormatVersionIsNamed) {
  const ScratchFolder folder;
  make_store(folder / "a");
  each_record(folder / "a", [](const std::string& table, const std::string& key, std::string& value) {
    if (table != "meta" || key != "store") return false;
    value[8] = 9;
    return true;
  });
  const std::string fault = fault_of(ErrorKind::kInput, [&] { Store::open_read(folder / "a"); });
  EXPECT_NE(fault.find("format version 9, expected 3"), std::string::npos) << fault;
}

}  // namespace
}  // namespace freshet::store
