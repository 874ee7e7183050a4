// Keys and signatures of any bytes: the key's line, then the signature's file. Whose signature is taken, takes no other
// store's.

#include <algorithm>

#include "platform/printable.h"
#include "store/signature.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

namespace {

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

bool is_taken(const std::filesystem::path& store, const std::string& key) {
  try {
    store::expect_signed(store, key);
    return true;
  } catch (const Error& error) {
    const std::string said = error.what();
    fuzz::expect(said == printable_lines(said) && (said.find(": ") != 0 || key.starts_with(": ")),
                 "an error names what it is of, printably");
    return false;
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const ScratchFolder folder;
  const fuzz::Data input(bytes, size);
  const auto end = std::ranges::find(input, '\n');
  const std::string key(input.begin(), end);
  const std::filesystem::path store = folder.path() / "of.store",
                              signature = folder.path() / "of.store.minisig";
  write(store, "A store.\n");
  write(signature, {end == input.end() ? end : end + 1, input.end()});
  if (is_taken(store, key)) {
    write(store, "A stork.\n");
    fuzz::expect(!is_taken(store, key), "another store's bytes are not taken");
  }
  // As a file, a key has a line before it.
  write(folder.path() / "key.pub", "untrusted comment: a key\n" + key + "\n");
  write(store, "A store.\n");
  fuzz::expect(is_taken(store, folder.path() / "key.pub") == is_taken(store, key) ||
                   key.find('\r') != std::string::npos || std::filesystem::exists(key),
               "a key is the same as words and as a file");
  return 0;
}
