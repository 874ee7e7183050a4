// What repair makes of a store that grew in several transactions and was damaged: no clip that can be read is left out
// without a word, and the index is that of one state, or absent.

#include <gtest/gtest.h>

#include "store/rewrite/rewrite.h"
#include "tests/store/raw_file.h"
#include "tests/store/rewrite/slow_salvage.h"

namespace freshet::store {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kWordBytes = 5;  // of a patch
const Rebuildable kIndex{.columns = {"patch.words"}, .blobs = {"codebook"}};

/// Nine clips, of which three have records that stand in pages of keys.
std::vector<TestClip> all_clips() {
  std::vector<TestClip> clips;
  for (std::uint64_t i = 0; i < 9; ++i) {
    TestClip clip{.name = "water/" + std::to_string(i) + ".mp4", .seed = i + 1, .rows = 10 + 400 * (i % 3)};
    clip.frames = i % 3 == 0 ? 3 : 18;
    if (i % 3 == 0) clip.planes = {{12, 8, 1}};
    clips.push_back(clip);
  }
  return clips;
}

/// As freshet index leaves it: words and a codebook that name the index they are of in every byte but some noise.
void add_index(Store& store, char number) {
  std::mt19937 random(static_cast<unsigned>(number));
  const auto bytes = [&](std::size_t size) {
    std::vector<std::byte> made(size);
    for (std::byte& byte : made) byte = static_cast<std::byte>(random());
    made[0] = static_cast<std::byte>(number);
    return made;
  };
  const Snapshot snapshot = store.snapshot();
  std::vector<std::vector<std::byte>> words;
  std::vector<Store::Column> columns;
  for (const ClipId id : snapshot.clips()) words.push_back(bytes(kWordBytes * snapshot.clip(id).rows));
  for (std::size_t i = 0; i < words.size(); ++i)
    columns.push_back({snapshot.clips()[i], "patch.words", words[i], kWordBytes});
  const std::vector<std::byte> codebook = bytes(9000);
  const Store::Blob blob{"codebook", codebook};
  store.write({&blob, 1}, columns);
}

class Repair : public testing::Test {
 protected:
  /// Five clips and an index, three clips and an index, one clip and an index; each part is a run of its own.
  Repair() {
    Store::create(file_, "{}");
    char number = 0;
    std::size_t done = 0;
    for (const std::size_t end : {5u, 8u, 9u}) {
      Store store = Store::open_write(file_);
      for (; done < end; ++done) {
        add_clip(store, clips_[done]);
        states_.push_back(file_bytes(file_));
      }
      add_index(store, ++number);
      states_.push_back(file_bytes(file_));
    }
  }

  /// Repairs a file of these bytes; false where it is refused.
  void expect_kept(const std::vector<char>& bytes, const std::string& what) {
    write_file(damaged_, bytes);
    fs::remove(out_);
    RepairReport report;
    try {
      report = repair(damaged_, out_, kIndex);
    } catch (const Error& error) {
      ASSERT_TRUE(error.kind() == ErrorKind::kInput || error.kind() == ErrorKind::kDamaged)
          << what << error.what();
      ++refused_;
      return;
    }
    const Store store = Store::open_read(out_);
    const Snapshot snapshot = store.snapshot();
    const std::vector<std::string> faults = snapshot.verify();
    ASSERT_TRUE(faults.empty()) << what << ": " << faults.front();
    ASSERT_EQ(snapshot.clips().size(), report.clips) << what;
    std::set<ReadableClip> said;
    for (const auto& lost : report.lost) said.insert({lost.name, lost.source_hash});
    for (const ClipId id : snapshot.clips()) {
      const ClipRecord& record = snapshot.clip(id);
      said.insert({record.name, record.source_hash});
      const auto made = std::ranges::find(clips_, record.name, &TestClip::name);
      ASSERT_TRUE(made != clips_.end() && reads_back(snapshot, id, *made)) << what << ": " << record.name;
      ++saved_;
    }
    for (const ReadableClip& clip : SlowSalvage(bytes, kIndex.columns).clips())
      ASSERT_TRUE(said.contains(clip))
          << what << ": " << clip.name << " can be read, and is neither saved nor named";
    expect_one_index(snapshot, report, what);
    if (report.saved_all()) {
      ASSERT_EQ(report.clips, clips_.size()) << what << ": nothing is said to be lost";
    }
  }

  void expect_one_index(const Snapshot& snapshot, const RepairReport& report, const std::string& what) {
    const auto codebook = snapshot.blob("codebook");
    if (report.index_left_out) {
      ASSERT_FALSE(codebook) << what;
    }
    for (const ClipId id : snapshot.clips()) {
      if (!codebook) {
        ASSERT_FALSE(snapshot.has_column(id, "patch.words")) << what << ": words of no codebook";
        continue;
      }
      // A clip that is newer than the index has none.
      if (!snapshot.has_column(id, "patch.words")) continue;
      ASSERT_EQ(snapshot.records<std::byte>(id, "patch.words", kWordBytes).at(0), codebook->at(0))
          << what << ": the words of clip " << static_cast<int>(id) << " are of another codebook";
    }
  }

  const std::vector<TestClip> clips_ = all_clips();
  const ScratchFolder folder_;
  const fs::path file_ = folder_ / "a", damaged_ = folder_ / "d", out_ = folder_ / "o";
  std::vector<std::vector<char>> states_;  // the file after each transaction
  int refused_ = 0;
  std::size_t saved_ = 0;
};

TEST_F(Repair, OfAWholeStoreTakesAllOfIt) {
  EXPECT_EQ(SlowSalvage(states_.back(), kIndex.columns).clips().size(), 9u);
  expect_kept(states_.back(), "whole");
  const RepairReport report = (fs::remove(out_), repair(file_, out_, kIndex));
  EXPECT_TRUE(report.saved_all() && !report.index_left_out);
  EXPECT_EQ(report.clips, 9u);
  EXPECT_EQ(Store::open_read(out_).snapshot().digest(), Store::open_read(file_).snapshot().digest());
}

// What a cut takes first is what was written last: the account.
TEST_F(Repair, OfAFileThatIsCutHidesNoClip) {
  const std::vector<char>& whole = states_.back();
  for (std::size_t pages = 1; pages <= 121 && pages * 4096 < whole.size(); pages += 3)
    ASSERT_NO_FATAL_FAILURE(
        expect_kept({whole.begin(), whole.end() - static_cast<std::ptrdiff_t>(pages * 4096)},
                    std::to_string(pages) + " pages cut"));
  EXPECT_GT(saved_, 120u);
  EXPECT_LT(refused_, 30);
}

// An older account knows of fewer clips. It does not say that there are no more.
TEST_F(Repair, WhereTheLastAccountsAreLostHidesNoClip) {
  std::vector<char> bytes = states_.back();
  for (auto state = states_.rbegin(); state != states_.rend(); ++state) {
    write_file(damaged_, *state);
    std::string account;
    each_record(damaged_, [&](const std::string& table, const std::string& key, std::string& value) {
      if (table == "meta" && key == "account") account = value;
      return false;
    });
    for (auto at = bytes.begin();
         (at = std::search(at, bytes.end(), account.begin(), account.end())) != bytes.end(); ++at)
      at[static_cast<std::ptrdiff_t>(account.size() - 1)] ^= 1;
    ASSERT_NO_FATAL_FAILURE(
        expect_kept(bytes, "an account of " + std::to_string(state->size()) + " bytes lost"));
    fs::remove(out_);
    const RepairReport report = repair(damaged_, out_, kIndex);
    EXPECT_EQ(report.clips, 9u);
    EXPECT_FALSE(report.saved_all());
  }
}

// A record that is lost with the account makes way for none that it replaced.
TEST_F(Repair, NeverJoinsOldWordsWithANewCodebook) {
  std::vector<std::pair<std::string, std::string>> records;
  each_record(file_, [&](const std::string& table, const std::string& key, std::string& value) {
    if (table == "clips" || table == "columns" || table == "blobs") records.emplace_back(table + key, value);
    return false;
  });
  int left_out = 0;
  for (const auto& [name, value] : records) {
    // Every copy of it: pages that were changed keep their old entries.
    std::vector<char> bytes = states_.back();
    for (auto at = bytes.begin();
         (at = std::search(at, bytes.end(), value.begin(), value.end())) != bytes.end(); ++at)
      at[static_cast<std::ptrdiff_t>(value.size() - 1)] ^= 1;
    ASSERT_NO_FATAL_FAILURE(expect_kept(bytes, name.substr(0, 7)));
    left_out += Store::open_read(out_).snapshot().blob("codebook") ? 0 : 1;
  }
  EXPECT_EQ(left_out, static_cast<int>(records.size()));
}

// Pages as they once were, after a write that the disk lost; bits, pages that are gone, exchanged or repeated; cuts.
TEST_F(Repair, OfAnyDamageHidesNoClip) {
  std::mt19937_64 random(17);
  const std::vector<char>& whole = states_.back();
  const std::size_t pages = whole.size() / 4096;
  const auto page_of = [](std::vector<char>& bytes, std::size_t page) {
    return bytes.begin() + static_cast<std::ptrdiff_t>(page * 4096);
  };
  for (int round = 0; round < 150; ++round) {
    std::vector<char> bytes = whole;
    std::string what = "round " + std::to_string(round);
    for (std::uint64_t i = 0; i < 1 + random() % 4; ++i) {
      const std::size_t page = random() % pages, other = random() % pages;
      const std::vector<char>& old = states_[random() % states_.size()];
      switch (random() % 6) {
        case 0:
          bytes[random() % bytes.size()] ^= static_cast<char>(1u << random() % 8);
          break;
        case 1:
          std::fill_n(page_of(bytes, page), 4096, '\0');
          break;
        case 2:
          std::copy_n(whole.begin() + static_cast<std::ptrdiff_t>(other * 4096), 4096, page_of(bytes, page));
          break;
        case 3:  // a page of the past
          if ((page + 1) * 4096 <= old.size())
            std::copy_n(old.begin() + static_cast<std::ptrdiff_t>(page * 4096), 4096, page_of(bytes, page));
          break;
        case 4:  // a meta page of the past, or both
          std::copy_n(old.begin(), 4096 * (1 + random() % 2), bytes.begin());
          break;
        default:
          bytes[page * 4096 + random() % 200] ^= static_cast<char>(1u << random() % 8);
      }
    }
    if (random() % 8 == 0) bytes.resize(random() % bytes.size());
    ASSERT_NO_FATAL_FAILURE(expect_kept(bytes, what));
  }
  EXPECT_GT(saved_, 750u);
  EXPECT_LT(refused_, 30);
}

// The store's numbers belong to clips; what an ingest that was killed has left bears one that was given again.
TEST_F(Repair, NamesAWholeClipWhoseNumberIsAnothers) {
  Store::create(damaged_, "{}", 5);
  write_file(out_, file_bytes(damaged_));
  {
    Store one = Store::open_write(damaged_), other = Store::open_write(out_);
    add_clip(one, clips_[0]);
    add_clip(other, clips_[1]);
  }
  std::vector<char> bytes = file_bytes(damaged_);
  const std::vector<char> behind = file_bytes(out_);
  // All pages of the other, moved behind those of the first one.
  const std::uint64_t moved = bytes.size() / 4096;
  std::vector<char> copy = behind;
  for (std::size_t page = 2; page < copy.size() / 4096; ++page) {
    char* at = copy.data() + page * 4096;
    std::uint16_t kind = 0, lower = 0;
    std::memcpy(&kind, at + 10, 2);
    std::memcpy(&lower, at + 12, 2);
    for (std::size_t i = 16; kind == 2 && i < lower; i += 2) {
      std::uint16_t place = 0, flags = 0, key = 0;
      std::memcpy(&place, at + i, 2);
      std::memcpy(&flags, at + place + 4, 2);
      std::memcpy(&key, at + place + 6, 2);
      if (flags != 1) continue;
      std::uint64_t first = 0;
      std::memcpy(&first, at + place + 8 + key, 8);
      first += moved;
      std::memcpy(at + place + 8 + key, &first, 8);
    }
  }
  bytes.insert(bytes.end(), copy.begin(), copy.end());
  write_file(damaged_, bytes);
  fs::remove(out_);
  const RepairReport report = repair(damaged_, out_, kIndex);
  EXPECT_EQ(report.clips, 1u);
  ASSERT_EQ(report.lost.size(), 1u);
  EXPECT_EQ(report.lost[0].name, clips_[1].name);
  EXPECT_NE(report.lost[0].fault.find(clips_[0].name), std::string::npos) << report.lost[0].fault;
}

}  // namespace
}  // namespace freshet::store
