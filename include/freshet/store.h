// include/freshet/store.h — one file of clips, open for reading.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace freshet {

struct Clip {
  std::string name;           // path below the folder that was ingested; unique in a store
  std::string class_name;     // water, fire, ...
  std::string licence;        // free text; may be empty
  int width = 0, height = 0;  // px
  std::uint32_t frames = 0;
  double fps = 0;  // frames per second, average
  std::uint64_t patches = 0;
};

/// A store as it was when it was opened: clips that are added later are not seen. Copies share what was read;
/// there is no empty one. Safe from many threads.
class Store {
 public:
  /// Needs no write permission. Throws Error{kInput} when there is no such file or it is no store,
  /// Error{kDamaged} when it was one.
  explicit Store(const std::filesystem::path& path);
  Store(const Store&) = default;  // and no moves: they would leave an empty one
  Store& operator=(const Store&) = default;

  std::filesystem::path path() const;
  /// In the order in which they were added.
  std::vector<Clip> clips() const;
  /// The number of each clip's first patch, patches being numbered through the store; and of all at the end.
  std::vector<std::uint64_t> first_patches() const;
  /// One hash (32 hex digits) of all content, whatever the order of the clips. Reads everything.
  std::string digest() const;
  /// Reads everything. One line per damaged record; empty when all is well.
  std::vector<std::string> verify() const;

  /// For the library's own use.
  struct Impl;
  const Impl& impl() const& { return *impl_; }
  const Impl& impl() && = delete;

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace freshet
