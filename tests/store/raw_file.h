// tests/store/raw_file.h — a store's LMDB file and bytes, behind the engine's back.
#pragma once

#include <lmdb.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>

#include "tests/store/clip_samples.h"

namespace freshet::store {

inline std::vector<char> file_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_file(const std::filesystem::path& file, const std::vector<char>& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Opens a store's table, lets `change` work on it, and commits.
inline void edit_table(const std::filesystem::path& file, const char* table,
                       const std::function<void(MDB_txn* txn, MDB_dbi dbi)>& change) {
  MDB_env* env = nullptr;
  mdb_env_create(&env);
  mdb_env_set_maxdbs(env, 8);
  mdb_env_set_mapsize(env, std::size_t{1} << 30);
  ASSERT_EQ(mdb_env_open(env, file.c_str(), MDB_NOSUBDIR | MDB_NOLOCK | MDB_NOSYNC, 0666), 0);
  MDB_txn* txn = nullptr;
  ASSERT_EQ(mdb_txn_begin(env, nullptr, 0, &txn), 0);
  MDB_dbi dbi = 0;
  ASSERT_EQ(mdb_dbi_open(txn, table, 0, &dbi), 0);
  change(txn, dbi);
  ASSERT_EQ(mdb_txn_commit(txn), 0);
  mdb_env_close(env);
}

inline void put_raw(MDB_txn* txn, MDB_dbi dbi, std::string key, std::string value) {
  MDB_val k{key.size(), key.data()}, v{value.size(), value.data()};
  ASSERT_EQ(mdb_put(txn, dbi, &k, &v, 0), 0);
}

inline void erase_raw(MDB_txn* txn, MDB_dbi dbi, std::string key) {
  MDB_val k{key.size(), key.data()};
  ASSERT_EQ(mdb_del(txn, dbi, &k, nullptr), 0);
}

/// Visits every record of the named tables. When visit returns true, the value is written
/// back as visit left it.
inline void each_record(
    const std::filesystem::path& file,
    const std::function<bool(const std::string& table, const std::string& key, std::string& value)>& visit) {
  for (const char* table : {"meta", "clips", "tiles", "columns", "blobs"})
    edit_table(file, table, [&](MDB_txn* txn, MDB_dbi dbi) {
      MDB_cursor* cursor = nullptr;
      ASSERT_EQ(mdb_cursor_open(txn, dbi, &cursor), 0);
      MDB_val key{}, value{};
      std::vector<std::pair<std::string, std::string>> changed;
      while (mdb_cursor_get(cursor, &key, &value, MDB_NEXT) == 0) {
        const std::string name(static_cast<char*>(key.mv_data), key.mv_size);
        std::string bytes(static_cast<char*>(value.mv_data), value.mv_size);
        if (visit(table, name, bytes)) changed.emplace_back(name, bytes);
      }
      mdb_cursor_close(cursor);
      for (auto& [name, bytes] : changed) put_raw(txn, dbi, name, bytes);
    });
}

}  // namespace freshet::store
