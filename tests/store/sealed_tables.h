// tests/store/sealed_tables.h — a store's records in memory, to be changed at will and then written as a store whose
// hashes and sums are all right: whoever makes a store computes them.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>

#include "store/records/account.h"
#include "store/records/clip_record.h"

namespace freshet::store {

class SealedTables {
 public:
  struct ByKey {
    bool operator()(const Bytes& a, const Bytes& b) const {
      return std::ranges::lexicographical_compare(a, b);
    }
  };
  using Records = std::map<Bytes, Bytes, ByKey>;  // values, header first, by their keys

  explicit SealedTables(std::uint64_t store_id, std::array<Records, kTables> tables = {})
      : id_(store_id), tables_(std::move(tables)) {}

  Records& table(Table table) { return tables_[static_cast<std::size_t>(table)]; }
  /// A value of at least kRecordHeaderBytes, given the hashes of what is there; replaces what has the key.
  void put(Table table, const Bytes& key, Bytes value);

  /// Decoded; empty where a record is not there or does not decode.
  std::optional<Bytes> payload(Table table, const Bytes& key) const;
  void put_payload(Table table, const Bytes& key, ByteSpan payload);
  std::string settings() const;
  void set_settings(const std::string& json);

  /// Those whose records can be read.
  std::map<ClipId, StoredClip> clips() const;
  void set_clip(ClipId id, const StoredClip& clip);

  /// All chunks of a column or blob, decoded.
  Bytes column(ClipId id, std::string_view name) const {
    return array(Table::kColumns, column_prefix(id, name));
  }
  Bytes blob(std::string_view name) const { return array(Table::kBlobs, blob_prefix(name)); }
  /// Of a clip that is then to be set; nothing takes the column away.
  void set_column(ClipId id, StoredClip& clip, const std::string& name, const std::optional<Bytes>& bytes,
                  std::uint32_t element_bytes);
  void set_blob(const std::string& name, ByteSpan bytes, std::uint32_t element_bytes, std::uint8_t flags);

  /// Gives clips, account and identity the sums of what is there, and writes the file.
  void write(const std::filesystem::path& file);

 private:
  Bytes array(Table table, const Bytes& prefix) const;
  ArrayAccount set_array(Table table, const Bytes& prefix, ByteSpan bytes, std::uint32_t element_bytes,
                         std::uint8_t flags);
  RecordSum sum_of(Table table, const Bytes& prefix) const;
  StoreAccount account() const;
  void add_up();

  std::uint64_t id_;
  std::array<Records, kTables> tables_;
};

}  // namespace freshet::store
