#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <utility>

#include "freshet/error.h"
#include "store/environment.h"
#include "store/lmdb_error.h"
#include "store/page_check.h"

namespace freshet::store {
namespace {

MDB_val to_val(ByteSpan bytes) { return {bytes.size(), const_cast<std::byte*>(bytes.data())}; }
ByteSpan from_val(const MDB_val& value) {
  return {static_cast<const std::byte*>(value.mv_data), value.mv_size};
}

struct CloseCursor {
  void operator()(MDB_cursor* cursor) const { mdb_cursor_close(cursor); }
};
using Cursor = std::unique_ptr<MDB_cursor, CloseCursor>;

Cursor open_cursor(const std::filesystem::path& file, MDB_txn* txn, MDB_dbi table) {
  MDB_cursor* cursor = nullptr;
  check_lmdb(file, "cannot be read", mdb_cursor_open(txn, table, &cursor));
  return Cursor(cursor);
}

// False at the end of the table.
bool move(const std::filesystem::path& file, const Cursor& cursor, MDB_val& key, MDB_val& value,
          MDB_cursor_op how) {
  const int code = mdb_cursor_get(cursor.get(), &key, &value, how);
  if (code == MDB_NOTFOUND) return false;
  check_lmdb(file, "cannot be read", code);
  return true;
}

bool begins_with(ByteSpan bytes, ByteSpan prefix) {
  return bytes.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), bytes.begin());
}

}  // namespace

ReadTransaction::ReadTransaction(std::shared_ptr<Environment> environment)
    : environment_(std::move(environment)) {
  txn_ = environment_->begin(MDB_RDONLY);
}

ReadTransaction::~ReadTransaction() { environment_->end(txn_); }

std::optional<ByteSpan> ReadTransaction::get(Table table, ByteSpan key) const {
  const std::lock_guard lock(mutex_);
  MDB_val at = to_val(key), value{};
  const int code = mdb_get(txn_, environment_->tables_[static_cast<std::size_t>(table)], &at, &value);
  if (code == MDB_NOTFOUND) return std::nullopt;
  check_lmdb(environment_->file(), "cannot be read", code);
  return from_val(value);
}

std::optional<ReadTransaction::Entry> ReadTransaction::floor(Table table, ByteSpan key) const {
  const std::lock_guard lock(mutex_);
  const auto& file = environment_->file();
  const Cursor cursor = open_cursor(file, txn_, environment_->tables_[static_cast<std::size_t>(table)]);
  MDB_val at = to_val(key), value{};
  if (move(file, cursor, at, value, MDB_SET_RANGE)) {
    if (std::ranges::equal(from_val(at), key)) return Entry{from_val(at), from_val(value)};
    if (!move(file, cursor, at, value, MDB_PREV)) return std::nullopt;
  } else if (!move(file, cursor, at, value, MDB_LAST)) {
    return std::nullopt;
  }
  return Entry{from_val(at), from_val(value)};
}

std::vector<ReadTransaction::Entry> ReadTransaction::entries(Table table, ByteSpan prefix) const {
  const std::lock_guard lock(mutex_);
  const auto& file = environment_->file();
  const Cursor cursor = open_cursor(file, txn_, environment_->tables_[static_cast<std::size_t>(table)]);
  std::vector<Entry> found;
  MDB_val key = to_val(prefix), value{};
  bool more = move(file, cursor, key, value, prefix.empty() ? MDB_FIRST : MDB_SET_RANGE);
  for (; more && begins_with(from_val(key), prefix); more = move(file, cursor, key, value, MDB_NEXT)) {
    found.push_back({from_val(key), from_val(value)});
  }
  return found;
}

void ReadTransaction::prefetch(Table table, ByteSpan prefix) const {
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (const Entry& entry : entries(table, prefix)) {
    const auto at = reinterpret_cast<std::uintptr_t>(entry.value.data()), begin = at / page * page;
    ::madvise(reinterpret_cast<void*>(begin), at + entry.value.size() - begin, MADV_WILLNEED);  // a hint
  }
}

WriteTransaction::WriteTransaction(std::shared_ptr<Environment> environment)
    : environment_(std::move(environment)) {
  if (environment_->access() != Access::kWrite) {
    throw Error(ErrorKind::kUsage, environment_->file().string(), "is open for reading only",
                "Open it for writing");
  }
  if (environment_->writer_thread_.load() == std::this_thread::get_id()) {
    throw Error(ErrorKind::kUsage, environment_->file().string(), "this thread is already adding to it",
                "Commit or drop the clip in hand first");
  }
  txn_ = environment_->begin_write();
}

WriteTransaction::~WriteTransaction() {
  if (txn_ == nullptr) return;
  if (has_written_out_) {
    mdb_txn_abort(std::exchange(txn_, nullptr));
    environment_->cut_uncommitted();
  }
  environment_->end_write(txn_);
}

// LMDB frees as many pages as the value's first one names, be they another's.
void WriteTransaction::expect_freeable(Table table, ByteSpan key, ByteSpan value) const {
  if (!can_be_freed(environment_->page_bytes(), key.size(), value))
    throw_damaged(place(table, key), "the header of the record's pages is garbled");
}

void WriteTransaction::put(Table table, ByteSpan key, ByteSpan value) {
  const MDB_dbi dbi = environment_->tables_[static_cast<std::size_t>(table)];
  MDB_val at = to_val(key), bytes = to_val(value);
  int code = mdb_put(txn_, dbi, &at, &bytes, MDB_APPEND);
  if (code == MDB_KEYEXIST) {  // not the last key: it belongs further up
    at = to_val(key);
    if (mdb_get(txn_, dbi, &at, &bytes) == 0) {
      expect_freeable(table, key, from_val(bytes));
      code = mdb_del(txn_, dbi, &at, nullptr);
      check_lmdb(environment_->file(), "cannot be written", code);
    }
    at = to_val(key);
    bytes = to_val(value);
    code = mdb_put(txn_, dbi, &at, &bytes, 0);
  }
  check_lmdb(environment_->file(), "cannot be written", code);
  unwritten_ += value.size();
  if (unwritten_ > kMostUnwritten) write_out();
}

// LMDB writes dirty pages out before the commit when it may run out of room for a list of 131,071 of them, but a value
// of many pages takes one place in that list: 131,071 values of 256 KB would be 34 GB of memory. There is no call for
// it. It makes room before it looks at what is put, though: a value of some 100,000 pages asks for all of the room
// there is, and as its key is a table's name, it is then refused, with nothing changed.
void WriteTransaction::write_out() {
  MDB_val name{std::strlen(kTableNames[0]), const_cast<char*>(kTableNames[0])};
  MDB_val value{std::size_t{100'000} * environment_->page_bytes(), nullptr};
  const int code = mdb_put(txn_, environment_->table_of_tables_, &name, &value, 0);
  if (code != MDB_INCOMPATIBLE) check_lmdb(environment_->file(), "cannot be written", code);
  unwritten_ = 0;
  has_written_out_ = true;
}

void WriteTransaction::erase(Table table, ByteSpan prefix) {
  const auto& file = environment_->file();
  const Cursor cursor = open_cursor(file, txn_, environment_->tables_[static_cast<std::size_t>(table)]);
  MDB_val key = to_val(prefix), value{};
  bool more = move(file, cursor, key, value, MDB_SET_RANGE);
  while (more && begins_with(from_val(key), prefix)) {
    expect_freeable(table, from_val(key), from_val(value));
    check_lmdb(file, "cannot be written", mdb_cursor_del(cursor.get(), 0));
    key = to_val(prefix);
    more = move(file, cursor, key, value, MDB_SET_RANGE);
  }
}

std::optional<Bytes> WriteTransaction::get(Table table, ByteSpan key) const {
  MDB_val at = to_val(key), value{};
  const int code = mdb_get(txn_, environment_->tables_[static_cast<std::size_t>(table)], &at, &value);
  if (code == MDB_NOTFOUND) return std::nullopt;
  check_lmdb(environment_->file(), "cannot be read", code);
  const ByteSpan bytes = from_val(value);
  return Bytes(bytes.begin(), bytes.end());
}

void WriteTransaction::each(Table table, const std::function<void(ByteSpan, ByteSpan)>& visit) const {
  const auto& file = environment_->file();
  const Cursor cursor = open_cursor(file, txn_, environment_->tables_[static_cast<std::size_t>(table)]);
  MDB_val key{}, value{};
  for (bool more = move(file, cursor, key, value, MDB_FIRST); more;
       more = move(file, cursor, key, value, MDB_NEXT)) {
    visit(from_val(key), from_val(value));
  }
}

void WriteTransaction::commit() {
  environment_->expect_in_place();
  const int code = mdb_txn_commit(txn_);  // frees the transaction, whatever it returns
  txn_ = nullptr;
  environment_->end_write(nullptr);
  check_lmdb(environment_->file(), "cannot be committed", code);
}

StoreAccount read_account(const WriteTransaction& txn) {
  const RecordPlace at = txn.place(Table::kMeta, bytes_of(kAccountKey));
  const auto value = txn.get(Table::kMeta, at.key);
  if (!value) throw_damaged(at, "the record is missing");
  auto account = parse_account(decode_record(at, *value, kMaxAccountBytes));
  if (!account) throw_damaged(at, "the store's account of its records is garbled");
  return std::move(*account);
}

void put_account(WriteTransaction& txn, const StoreAccount& account) {
  const RecordPlace at = txn.place(Table::kMeta, bytes_of(kAccountKey));
  const Bytes bytes = serialise_account(account);
  txn.put(Table::kMeta, at.key, encode_record(at, bytes, 1, bytes.size()));
}

}  // namespace freshet::store
