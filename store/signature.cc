#include "store/signature.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <sstream>
#include <vector>

#include "freshet/error.h"
#include "platform/printable.h"

namespace freshet::store {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<unsigned char>;

constexpr std::size_t kMostText = 1 << 16;  // bytes of a key's or a signature's file
constexpr std::size_t kHead = 2 + 8;        // algorithm, and the key's number
constexpr const char* kTrusted = "trusted comment: ";

[[noreturn]] void refuse(const fs::path& file, const std::string& fault, const std::string& remedy) {
  throw Error(ErrorKind::kInput, file.empty() ? "(no name)" : printable(file.string()), fault, remedy);
}

std::vector<std::string> lines_of(const fs::path& file, const std::string& remedy) {
  std::ifstream stream(file, std::ios::binary);
  std::string text(kMostText, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.gcount() == 0) refuse(file, "it cannot be read", remedy);
  text.resize(static_cast<std::size_t>(stream.gcount()));
  std::vector<std::string> lines;
  std::istringstream all(text);
  for (std::string line; std::getline(all, line);) {
    if (line.ends_with('\r')) line.pop_back();
    lines.push_back(line);
  }
  return lines;
}

/// Nothing unless the text is base64 of so many bytes.
std::optional<Bytes> decoded(const std::string& text, std::size_t count) {
  Bytes bytes(count);
  std::size_t got = 0;
  const bool done = sodium_base642bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &got,
                                      nullptr, sodium_base64_VARIANT_ORIGINAL) == 0;
  if (!done || got != count) return std::nullopt;
  return bytes;
}

Bytes public_key(const std::string& key) {
  constexpr const char* kRemedy = "Give the key that its maker has published, 56 letters, or the file .pub";
  std::optional<Bytes> bytes = decoded(key, kHead + crypto_sign_PUBLICKEYBYTES);
  if (!bytes) {
    const std::vector<std::string> lines = lines_of(key, kRemedy);
    if (lines.size() >= 2) bytes = decoded(lines[1], kHead + crypto_sign_PUBLICKEYBYTES);
  }
  if (!bytes || (*bytes)[0] != 'E' || (*bytes)[1] != 'd')
    refuse(key, "it is no public key of minisign", kRemedy);
  return *bytes;
}

Bytes hash_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse(file, "it cannot be read", "Check its name and its permissions");
  crypto_generichash_state state;
  crypto_generichash_init(&state, nullptr, 0, crypto_generichash_BYTES_MAX);
  std::vector<char> part(1 << 20);
  while (stream.read(part.data(), static_cast<std::streamsize>(part.size())), stream.gcount() > 0)
    crypto_generichash_update(&state, reinterpret_cast<const unsigned char*>(part.data()),
                              static_cast<unsigned long long>(stream.gcount()));
  Bytes hash(crypto_generichash_BYTES_MAX);
  crypto_generichash_final(&state, hash.data(), hash.size());
  return hash;
}

bool is_signed(const unsigned char* signature, const Bytes& what, const Bytes& key) {
  return crypto_sign_verify_detached(signature, what.data(), what.size(), key.data() + kHead) == 0;
}

}  // namespace

void expect_signed(const fs::path& store, const std::string& key) {
  constexpr const char* kRemedy =
      "Get the store and its .minisig again from its maker, or read it without --signed-by. Who makes one "
      "signs it with: minisign -Sm STORE";
  if (sodium_init() < 0) throw Error(ErrorKind::kIo, "libsodium", "it cannot be started");
  const Bytes maker = public_key(key);
  const fs::path file = store.string() + ".minisig";
  const std::vector<std::string> lines = lines_of(file, kRemedy);
  constexpr std::size_t kLines = 4;  // comment, signature, trusted comment, signature of both
  std::optional<Bytes> signature, of_both;
  if (lines.size() >= kLines && lines[2].starts_with(kTrusted)) {
    signature = decoded(lines[1], kHead + crypto_sign_BYTES);
    of_both = decoded(lines[3], crypto_sign_BYTES);
  }
  if (!signature || !of_both || (*signature)[0] != 'E')
    refuse(file, "it is no signature of minisign", kRemedy);
  if ((*signature)[1] != 'D')
    refuse(file, "it is a signature of the file itself, not of its hash", "Sign it anew: minisign -Sm STORE");
  if (!std::equal(maker.begin() + 2, maker.begin() + kHead, signature->begin() + 2))
    refuse(file, "another key signed it than the one that was given", kRemedy);
  if (!is_signed(signature->data() + kHead, hash_of(store), maker))
    refuse(store, "its bytes are not those that were signed", kRemedy);
  Bytes both(signature->begin() + kHead, signature->end());
  const std::string comment = lines[2].substr(std::string(kTrusted).size());
  both.insert(both.end(), comment.begin(), comment.end());
  if (!is_signed(of_both->data(), both, maker))
    refuse(file, "its comment is not the one that was signed", kRemedy);
}

}  // namespace freshet::store
