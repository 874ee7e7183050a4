// cache/result_cache.h — bytes kept on disk between runs, found by the hash of what they depend on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace freshet::cache {

/// 128 bits of everything that a result depends on.
struct Key {
  std::uint64_t high = 0, low = 0;
  auto operator<=>(const Key&) const = default;
};

std::string hex(const Key& key);  // 32 digits

/// XXH3-128 of what is added, in order. Not against forgery: a cache is as trusted as its folder.
class KeyHash {
 public:
  KeyHash();
  KeyHash(KeyHash&&) noexcept;
  ~KeyHash();
  void bytes(std::span<const std::byte> bytes);  // without their number
  template <class T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    bytes(std::as_bytes(std::span(&value, 1)));
  }
  template <class T>
  void add(std::span<const T> values) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    add(std::uint64_t{values.size()});
    bytes(std::as_bytes(values));
  }
  void add(const std::string& text) { add(std::span<const char>(text)); }
  void add(const Key& key) {
    add(key.high);
    add(key.low);
  }
  Key key() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A folder of packs (*.labels), each what one run added: entries, and a directory at the end. Nothing of
/// them is trusted: a pack that is damaged, cut or of another version is left out, said in take_notices(),
/// and removed by finish(). Several processes may use one folder at once.
class ResultCache {
 public:
  /// Makes the folder when there is none.
  /// max_bytes   of all packs together: those that were not used for the longest go first; at most 256 are
  ///             kept.
  /// Throws      Error{kIo} when the folder cannot be made or read.
  explicit ResultCache(const std::filesystem::path& folder,
                       std::uintmax_t max_bytes = std::uintmax_t{2} << 30);
  ResultCache(const ResultCache&) = delete;
  ResultCache& operator=(const ResultCache&) = delete;
  ~ResultCache();

  /// What was kept under the key, by this run or an earlier one; its hash is checked.
  std::optional<std::vector<std::byte>> find(const Key& key);
  /// Written at once; a key that is already there is left as it is. A full disk ends the keeping, with a
  /// notice: a cache is no reason to fail.
  void keep(const Key& key, std::span<const std::byte> bytes);
  /// Makes what was kept visible to later runs, and removes what is too much. Called by the destructor as
  /// well, there without a word.
  void finish();

  /// For a person; since the last call.
  std::vector<std::string> take_notices();
  const std::filesystem::path& folder() const { return folder_; }

 private:
  struct Entry {
    std::uint64_t offset = 0, length = 0, hash = 0;
  };
  struct Pack;
  struct Place {
    std::size_t pack = 0;
    Entry entry;
  };
  void open(const std::filesystem::path& path);
  void give_up(const std::string& why);
  void evict();

  std::filesystem::path folder_;
  std::uintmax_t max_bytes_;
  std::mutex guard_;
  std::vector<std::unique_ptr<Pack>> packs_;
  std::map<Key, Place> places_;
  std::unique_ptr<Pack> own_;  // being written; null before the first keep() and after the last
  std::map<Key, Entry> added_;
  std::vector<std::filesystem::path> damaged_;
  std::vector<std::string> notices_;
  bool given_up_ = false;
};

}  // namespace freshet::cache
