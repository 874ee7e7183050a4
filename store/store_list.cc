#include "store/store_list.h"

#include <sstream>

#include "freshet/error.h"
#include "platform/text.h"
#include "platform/text_file.h"

namespace freshet::store {

bool is_store_list(const std::filesystem::path& path) { return lower_ending(path) == ".stores"; }

std::vector<std::filesystem::path> read_store_list(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = 1 << 20;
  static constexpr const char* kSpace = " \t\r";
  const char* const remedy = "Write the name of a store in each of its lines";
  std::istringstream text(read_text_file(path, kMaxBytes, remedy));
  std::vector<std::filesystem::path> stores;
  for (std::string line; std::getline(text, line);) {
    const std::size_t begin = line.find_first_not_of(kSpace);
    if (begin == std::string::npos || line[begin] == '#') continue;
    const std::filesystem::path store =
        path.parent_path() / line.substr(begin, line.find_last_not_of(kSpace) + 1 - begin);
    if (is_store_list(store))
      throw Error(ErrorKind::kInput, path.string(), "names another list, " + store.string(), remedy);
    stores.push_back(store);
  }
  if (stores.empty()) throw Error(ErrorKind::kInput, path.string(), "names no store", remedy);
  return stores;
}

std::vector<std::filesystem::path> stores_named(const std::filesystem::path& path) {
  return is_store_list(path) ? read_store_list(path) : std::vector{path};
}

void expect_one_store(const std::filesystem::path& path) {
  if (!is_store_list(path)) return;
  std::string names;
  for (const std::filesystem::path& store : read_store_list(path)) names += "\n  " + store.string();
  throw Error(ErrorKind::kUsage, path.string(), "is a list of stores, and this works on one",
              "Name one of them:" + names);
}

void expect_store_name(const std::filesystem::path& path) {
  if (!is_store_list(path)) return;
  throw Error(ErrorKind::kUsage, path.string(), "a name that ends so is that of a list of stores",
              "Give the store another name");
}

}  // namespace freshet::store
