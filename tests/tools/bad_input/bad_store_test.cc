// Files that are no store, stores of other versions, damaged ones, and those that may not be written to.

#include <gtest/gtest.h>
#include <lmdb.h>
#include <unistd.h>

#include <cstring>

#include "store/store.h"
#include "tests/tools/sample.h"

namespace freshet::tools {
namespace {

namespace fs = std::filesystem;

class BadStore : public testing::Test {
 protected:
  /// Every command that opens a store says the same of it, and leaves its bytes alone.
  void expect_no_store(const std::string& name, const std::string& fault, int exit_code = 1) {
    const std::string before = fs::is_regular_file(folder_ / name) ? text_of(folder_ / name) : "";
    const std::vector<std::vector<std::string>> commands{
        {"store", "info", name},
        {"store", "verify", name},
        {"index", name},
        {"query", "label", name, sample().still},
        {"synth", "animate", name, sample().still, "--whole", "-o", "out.mkv"},
        {"ingest", name, sample().clips}};
    for (const auto& command : commands) {
      const Outcome outcome = folder_.freshet(command);
      EXPECT_EQ(outcome.exit_code, exit_code) << command[0] << ": " << outcome.err;
      EXPECT_EQ(outcome.out, "");
      EXPECT_NE(outcome.err.find("freshet: " + name + ": "), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find(fault), std::string::npos) << command[0] << ": " << outcome.err;
    }
    if (fs::is_regular_file(folder_ / name)) {
      EXPECT_EQ(text_of(folder_ / name), before);
    }
  }

  WorkFolder folder_;
};

TEST_F(BadStore, OtherFilesAreNotTakenForOne) {
  folder_.file("text.store", "A text.\n");
  folder_.file("empty.store", "");
  folder_.file("sqlite.store", std::string("SQLite format 3\0", 16) + std::string(8176, '\0'));
  expect_no_store("text.store", "is not a Freshet store");
  expect_no_store("empty.store", "is not a Freshet store");
  expect_no_store("sqlite.store", "is not a Freshet store");
}

TEST_F(BadStore, AFolderIsNoStore) {
  fs::create_directories(folder_ / "folder.store");
  expect_no_store("folder.store", "is not a file");
}

TEST_F(BadStore, OneThatIsNotThereIsMadeByIngestAlone) {
  const Outcome outcome = folder_.freshet({"store", "info", "none.store"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.err.find("none.store: cannot be opened (No such file"), std::string::npos) << outcome.err;
  EXPECT_FALSE(fs::exists(folder_ / "none.store"));
}

/// Opens an LMDB file, lets `change` work on one of its tables, and commits.
template <class Change>
void with_table(const fs::path& file, const char* name, Change&& change) {
  MDB_env* env = nullptr;
  MDB_txn* txn = nullptr;
  MDB_dbi table = 0;
  ASSERT_EQ(mdb_env_create(&env), 0);
  mdb_env_set_maxdbs(env, 8);
  mdb_env_set_mapsize(env, std::size_t{1} << 28);
  ASSERT_EQ(mdb_env_open(env, file.c_str(), MDB_NOSUBDIR | MDB_NOLOCK, 0666), 0);
  ASSERT_EQ(mdb_txn_begin(env, nullptr, 0, &txn), 0);
  ASSERT_EQ(mdb_dbi_open(txn, name, MDB_CREATE, &table), 0);
  change(txn, table);
  ASSERT_EQ(mdb_txn_commit(txn), 0);
  mdb_env_close(env);
}

void put(MDB_txn* txn, MDB_dbi table, std::string key, std::string value) {
  MDB_val k{key.size(), key.data()}, v{value.size(), value.data()};
  ASSERT_EQ(mdb_put(txn, table, &k, &v, 0), 0);
}

TEST_F(BadStore, AnLmdbFileOfAnotherProgram) {
  with_table(folder_ / "other.store", "things",
             [](MDB_txn* txn, MDB_dbi table) { put(txn, table, "colour", "blue"); });
  expect_no_store("other.store", "is an LMDB file but not a Freshet store");
}

TEST_F(BadStore, AStoreOfANewerVersionIsToldFromADamagedOne) {
  const fs::path store = copy_of_store(folder_, "newer.store");
  with_table(store, "meta", [](MDB_txn* txn, MDB_dbi table) {
    std::string key = "store";
    MDB_val k{key.size(), key.data()}, v{};
    ASSERT_EQ(mdb_get(txn, table, &k, &v), 0);
    std::string identity(static_cast<char*>(v.mv_data), v.mv_size);
    ASSERT_EQ(identity.substr(0, 8), "FRESHET\n");
    identity[8] = 9;  // docs/format.md: the version is compared before anything else
    put(txn, table, key, identity);
  });
  expect_no_store("newer.store", "version 9");
}

TEST_F(BadStore, VerifyNamesTheRecordThatWasDamaged) {
  const fs::path store = copy_of_store(folder_);
  std::string bytes = text_of(store);
  for (std::size_t i = 0; i < 64; ++i) bytes[bytes.size() / 2 + 3 * i] ^= 0x5a;
  folder_.file("copy.store", bytes);
  const Outcome verify = folder_.freshet({"store", "verify", "copy.store"});
  EXPECT_EQ(verify.exit_code, 3) << verify.err;
  EXPECT_NE(verify.out.find("copy.store, clip "), std::string::npos) << verify.out;
  EXPECT_NE(verify.err.find("Restore the file from a copy"), std::string::npos) << verify.err;
}

TEST_F(BadStore, InfoGivesNoNumbersOfADamagedStoreAsIfAllWereWell) {
  const std::string whole = text_of(sample().store);
  const std::size_t pages = whole.size() / 4096;
  const auto info_of = [&](const std::string& bytes) {
    folder_.file("bad.store", bytes);
    return folder_.freshet({"store", "info", "bad.store"});
  };
  const Outcome right = info_of(whole);
  ASSERT_EQ(right.exit_code, 0) << right.err;
  int noticed = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    const std::size_t page = i < 20 ? 2 + i * (pages - 2) / 20 : pages - 1 - (i - 20);
    const std::size_t other = 2 + (page * 7 + i) % (pages - 2);
    std::string zeroed = whole, swapped = whole, repeated = whole;
    zeroed.replace(page * 4096, 4096, 4096, '\0');
    swapped.replace(page * 4096, 4096, whole, other * 4096, 4096);
    swapped.replace(other * 4096, 4096, whole, page * 4096, 4096);
    repeated.replace(page * 4096, 4096, whole, other * 4096, 4096);
    for (const std::string* bytes : {&zeroed, &swapped, &repeated}) {
      const Outcome outcome = info_of(*bytes);
      EXPECT_EQ(outcome.signal, 0) << "page " << page;
      // A page in the middle of a value, or a free one, changes no number.
      if (outcome.exit_code == 0) {
        EXPECT_TRUE(outcome.out == right.out) << "page " << page << ", " << other << outcome.out;
      }
      noticed += outcome.exit_code == 3 ? 1 : 0;
    }
  }
  EXPECT_GE(noticed, 20);
}

/// A cursor at a table's first record.
void open_at_first(MDB_txn* txn, MDB_dbi table, MDB_cursor*& cursor, MDB_val& key, MDB_val& value) {
  ASSERT_EQ(mdb_cursor_open(txn, table, &cursor), 0);
  ASSERT_EQ(mdb_cursor_get(cursor, &key, &value, MDB_FIRST), 0);
}

TEST_F(BadStore, InfoDoesNotSayWhatItsRecordsUnpackToWhereAHeaderIsDamaged) {
  const fs::path store = copy_of_store(folder_);
  with_table(store, "columns", [](MDB_txn* txn, MDB_dbi table) {
    MDB_cursor* cursor = nullptr;
    MDB_val k{}, v{};
    ASSERT_NO_FATAL_FAILURE(open_at_first(txn, table, cursor, k, v));
    const std::string key(static_cast<char*>(k.mv_data), k.mv_size);
    std::string value(static_cast<char*>(v.mv_data), v.mv_size);
    mdb_cursor_close(cursor);
    value[20] = 8;  // docs/format.md: bytes 16 to 23 say how many it unpacks to; 32 GB more
    put(txn, table, key, value);
  });
  const Outcome info = folder_.freshet({"store", "info", "copy.store"});
  EXPECT_EQ(info.exit_code, 3) << info.err;
  EXPECT_EQ(info.out.find("34.4 GB"), std::string::npos) << info.out;
  EXPECT_NE(info.out.find("frames"), std::string::npos) << info.out;
  const Outcome json = folder_.freshet({"store", "info", "copy.store", "--json"});
  EXPECT_NE(json.out.find("\"raw_bytes\": null"), std::string::npos) << json.out;
}

TEST_F(BadStore, InfoNamesARecordThatIsLost) {
  const fs::path store = copy_of_store(folder_);
  with_table(store, "columns", [](MDB_txn* txn, MDB_dbi table) {
    MDB_cursor* cursor = nullptr;
    MDB_val key{}, value{};
    ASSERT_NO_FATAL_FAILURE(open_at_first(txn, table, cursor, key, value));
    ASSERT_EQ(mdb_cursor_del(cursor, 0), 0);
  });
  const Outcome outcome = folder_.freshet({"store", "info", "copy.store"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_NE(outcome.out.find("damaged: copy.store, clip 0, column"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.err.find(": 1 damaged record. "), std::string::npos) << outcome.err;
}

// Whoever makes a store writes what he likes, with hashes that are right.
TEST_F(BadStore, TextsThatAreNoJsonAreNamedAndNamesMoveNoTerminal) {
  const fs::path file = folder_ / "odd.store";
  {
    store::Store odd = store::Store::create(file, "{\"patch\": ");
    store::ClipWriter writer = odd.add_clip();
    store::ClipRecord record;
    record.name = "x\033]0;PWNED\007";
    record.source_hash = "a";
    record.metadata = "[1, ";
    writer.commit(record);
  }
  for (const char* command : {"info", "verify"}) {
    const Outcome outcome = folder_.freshet({"store", command, "odd.store"});
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_NE(outcome.out.find("odd.store, clip \"x"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("odd.store: its settings are no JSON"), std::string::npos) << outcome.out;
    EXPECT_EQ((outcome.out + outcome.err).find_first_of("\033\007"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.err.find("unexpected"), std::string::npos) << outcome.err;
  }
  EXPECT_EQ(folder_.freshet({"store", "info", "odd.store", "--json"}).exit_code, 3);
}

TEST_F(BadStore, WhateverByteIsDamagedAnAnswerIsRightOrThereIsNone) {
  const std::vector<std::string> label{"query",    "label", sample().store, sample().still,
                                       "--frames", "16",    "--json"};
  const auto assignment = [](const std::string& json) { return json.substr(json.find("\"assignment\"")); };
  const auto until_seconds = [&](const std::string& json) {
    // "assignment" comes before "seconds" in the sorted output; times differ from run to run.
    return assignment(json).substr(0, assignment(json).find("\"seconds\""));
  };
  const Outcome right = folder_.freshet(label);
  ASSERT_EQ(right.exit_code, 0) << right.err;
  const std::string whole = text_of(sample().store);
  int noticed = 0;
  for (int i = 0; i < 12; ++i) {
    std::string bytes = whole;
    const std::size_t at = whole.size() * (2 * i + 1) / 24;
    for (std::size_t k = 0; k < 512; ++k) bytes[at + k] = static_cast<char>(bytes[at + k] ^ (0x11 + k));
    folder_.file("bad.store", bytes);
    std::vector<std::string> command = label;
    command[2] = "bad.store";
    const Outcome outcome = folder_.freshet(command);
    EXPECT_EQ(outcome.signal, 0) << "bytes from " << at;
    if (outcome.exit_code == 0) {
      EXPECT_EQ(until_seconds(outcome.out), until_seconds(right.out)) << "bytes from " << at;
    } else {
      EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
      EXPECT_NE(outcome.err.find("bad.store"), std::string::npos) << outcome.err;
    }
    noticed += folder_.freshet({"store", "verify", "bad.store"}).exit_code == 3;
    fs::remove(folder_ / "bad.store-lock");
  }
  EXPECT_GE(noticed, 10) << "512 bytes can lie in a free page, but not every time";
}

TEST_F(BadStore, WhereTooFewFilesMayBeOpenedTheRemedyIsThat) {
  copy_of_store(folder_);
  const std::vector<std::vector<std::string>> commands{
      {"store", "info", "copy.store"},
      {"store", "repair", "copy.store", "-o", "new.store"},
      {"query", "candidates", "copy.store", sample().still, "--whole"}};
  int said = 0;
  for (const auto& command : commands)
    for (const int limit : {5, 6, 7, 8}) {
      const Outcome outcome = folder_.freshet_after("ulimit -n " + std::to_string(limit), command);
      if (outcome.err.find("Too many open files") == std::string::npos) continue;  // not loaded, or enough
      EXPECT_EQ(outcome.exit_code, 1) << limit;
      EXPECT_TRUE(outcome.err.find("ulimit -n") != std::string::npos ||
                  outcome.err.find("Close other files") != std::string::npos)
          << command[1] << " " << limit << outcome.err;
      said += outcome.err.find("ulimit -n") != std::string::npos ? 1 : 0;
    }
  EXPECT_GE(said, 2);
}

TEST_F(BadStore, ACutOneIsDamaged) {
  folder_.file("cut.store", text_of(sample().store).substr(0, fs::file_size(sample().store) / 2));
  expect_no_store("cut.store", "the file has been cut", 3);
}

TEST_F(BadStore, AReadOnlyFileInAReadOnlyFolderCanBeSearched) {
  fs::create_directories(folder_ / "safe");
  copy_of_store(folder_, "safe/a.store");
  // Root may write to anything but what is mounted for reading alone.
  std::string preparation = "chmod -R a-w safe";
  std::vector<std::string> prefix{"sh", "-c", preparation + "; exec \"$@\"", "sh"};
  if (::geteuid() == 0) {
    if (folder_.run({"unshare", "-m", "true"}).exit_code != 0)
      GTEST_SKIP() << "root here may not mount: run as another user, or where unshare -m works";
    prefix = {
        "unshare", "-m", "sh", "-c", "mount --bind safe safe && mount -o remount,bind,ro safe && exec \"$@\"",
        "sh"};
  }
  const auto run = [&](std::vector<std::string> arguments) {
    std::vector<std::string> command = prefix;
    command.push_back(executable());
    command.insert(command.end(), arguments.begin(), arguments.end());
    return folder_.run(command);
  };
  const Outcome query = run({"query", "candidates", "safe/a.store", sample().still, "--frames", "16"});
  EXPECT_EQ(query.exit_code, 0) << query.err;
  EXPECT_EQ(run({"store", "verify", "safe/a.store"}).exit_code, 0);
  const Outcome ingest = run({"ingest", "safe/a.store", sample().clips});
  EXPECT_EQ(ingest.exit_code, 1);
  EXPECT_NE(ingest.err.find("safe/a.store: cannot be opened"), std::string::npos) << ingest.err;
  EXPECT_NE(ingest.err.find("permissions"), std::string::npos) << ingest.err;
  fs::permissions(folder_ / "safe", fs::perms::owner_all, fs::perm_options::add);
}

}  // namespace
}  // namespace freshet::tools
