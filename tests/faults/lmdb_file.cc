#include "tests/faults/lmdb_file.h"

#include <cstring>
#include <stdexcept>

namespace freshet::tools {

std::uint64_t number_at(const std::string& file, std::size_t at, std::size_t bytes) {
  std::uint64_t value = 0;
  if (at + bytes > file.size()) throw std::runtime_error("no such place in the file");
  std::memcpy(&value, file.data() + at, bytes);
  return value;
}

void put_number(std::string& file, std::size_t at, std::size_t bytes, std::uint64_t value) {
  if (at + bytes > file.size()) throw std::runtime_error("no such place in the file");
  std::memcpy(file.data() + at, &value, bytes);
}

LmdbFile::LmdbFile(std::string file) : bytes(std::move(file)) {
  live = number_at(bytes, 144, 8) >= number_at(bytes, kPage + 144, 8) ? 0 : 1;
  last = number_at(bytes, live * kPage + 136, 8);
  trees = {{"free", live * kPage + 40}, {"main", live * kPage + 88}};
  walk("free");
  walk("main");
  const std::vector<Entry> named = entries;
  for (const Entry& entry : named)
    if (entry.tree == "main" && entry.leaf && entry.flags == kSubTree) trees[key_of(entry)] = entry.value;
  for (const auto& [name, at] : trees)
    if (name != "free" && name != "main") walk(name);
}

std::size_t LmdbFile::value_at(const Entry& entry) const {
  return entry.apart() ? number_at(bytes, entry.value, 8) * kPage + kPageHeader : entry.value;
}

void LmdbFile::walk(const std::string& tree) {
  const std::size_t at = trees.at(tree);
  if (const std::uint64_t root = number_at(bytes, at + 40, 8); root != kNoPage)
    walk_page(tree, root, number_at(bytes, at + 6, 2));
}

void LmdbFile::walk_page(const std::string& tree, std::uint64_t number, std::uint64_t depth) {
  const std::size_t begin = number * kPage;
  pages.push_back({tree, number});
  const std::size_t count = (number_at(bytes, begin + 12, 2) - kPageHeader) / 2;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = begin + number_at(bytes, begin + kPageHeader + 2 * i, 2);
    Entry entry{.tree = tree,
                .page = number,
                .index = i,
                .at = at,
                .leaf = depth == 1,
                .key_bytes = number_at(bytes, at + 6, 2),
                .value_bytes = 0,
                .flags = static_cast<std::uint16_t>(number_at(bytes, at + 4, 2)),
                .value = at + 8 + number_at(bytes, at + 6, 2)};
    if (entry.leaf) {
      entry.value_bytes = number_at(bytes, at, 4);
      if (entry.apart())
        apart.push_back(
            {tree, number_at(bytes, entry.value, 8), store::lmdb::pages_of(entry.value_bytes, kPage)});
    }
    entries.push_back(entry);
    if (!entry.leaf) walk_page(tree, number_at(bytes, at, 6), depth - 1);
  }
}

}  // namespace freshet::tools
