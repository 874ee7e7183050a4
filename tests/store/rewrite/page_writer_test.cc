#include "store/rewrite/page_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <map>

#include "store/page_check.h"
#include "tests/store/raw_file.h"

namespace freshet::store {
namespace {

using Table = std::map<std::string, std::string>;

/// What LMDB reads of a table.
Table read_table(const std::filesystem::path& file, const std::string& name) {
  Table table;
  each_record(file, [&](const std::string& of, const std::string& key, std::string& value) {
    if (of == name) table[key] = value;
    return false;
  });
  return table;
}

std::uint64_t write_tables(const std::filesystem::path& file, const std::map<std::string, Table>& tables) {
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_TRUNC, 0666);
  PageWriter writer(fd, file), counter(-1, file);
  for (const auto& [name, table] : tables) {
    writer.begin_table(name);
    counter.begin_table(name);
    for (const auto& [key, value] : table) {
      writer.add(bytes_of(key), bytes_of(value));
      counter.count(bytes_of(key), value.size());
    }
  }
  const std::uint64_t bytes = writer.finish();
  EXPECT_EQ(counter.finish(), bytes);
  EXPECT_EQ(std::filesystem::file_size(file), bytes);
  check_pages(fd, file, PageCheck::kAll);
  ::close(fd);
  return bytes;
}

// Any keys and sizes, from none to two levels of branches; LMDB goes on with it as with its own.
TEST(PageWriter, WritesWhatLmdbReadsAndChanges) {
  const ScratchFolder folder;
  std::mt19937_64 random(5);
  for (const int most : {0, 1, 2, 40, 3000, 30000}) {
    std::map<std::string, Table> tables;
    for (const char* name : {"meta", "clips", "tiles", "columns", "blobs"}) {
      Table& table = tables[name];
      for (int i = 0; i < most; ++i) {
        std::string key(most > 3000 ? 8 : 1 + random() % 511, '\0');
        for (char& c : key) c = static_cast<char>(random());
        const std::size_t size = random() % 3 == 0 ? random() % 2100 : random() % 60;
        table[key] =
            std::string(most <= 40 && random() % 4 == 0 ? random() % 20000 : size, static_cast<char>(i));
      }
      if (most > 3000) break;
    }
    for (const char* name : {"meta", "clips", "tiles", "columns", "blobs"}) tables[name];
    const std::filesystem::path file = folder / std::to_string(most);
    write_tables(file, tables);
    for (const auto& [name, table] : tables) ASSERT_EQ(read_table(file, name), table) << most << name;
    for (int round = 0; round < 20 && most > 0; ++round)
      edit_table(file, "meta", [&](MDB_txn* txn, MDB_dbi dbi) {
        Table& table = tables["meta"];
        for (int i = 0; i < most / 20 + 1 && !table.empty(); ++i) {
          erase_raw(txn, dbi, table.begin()->first);
          table.erase(table.begin());
        }
        std::string key = "new " + std::to_string(round);
        put_raw(txn, dbi, key, std::string(5000, 'v'));
        table[key] = std::string(5000, 'v');
      });
    ASSERT_EQ(read_table(file, "meta"), tables["meta"]);
    const int fd = ::open(file.c_str(), O_RDONLY);
    check_pages(fd, file, PageCheck::kAll);
    ::close(fd);
  }
}

TEST(PageWriter, ReportsAFullDisk) {
  const int fd = ::open("/dev/full", O_RDWR);
  ASSERT_GE(fd, 0);
  PageWriter writer(fd, "full");
  writer.begin_table("tiles");
  const Bytes value(3 << 20);
  EXPECT_EQ(kind_of([&] {
              writer.add(bytes_of("key"), value);
              writer.finish();
            }),
            ErrorKind::kIo);
  ::close(fd);
}

}  // namespace
}  // namespace freshet::store
