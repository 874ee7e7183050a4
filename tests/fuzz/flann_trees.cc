// FLANN's trees of any bytes, under a hash that is right: loaded and searched, or refused.

#include <xxhash.h>

#include <array>
#include <cstring>
#include <random>

#include "query/index/flann_index.h"
#include "tests/fuzz/fuzz.h"

using namespace freshet;

namespace {

constexpr int kWords = 3;
constexpr std::size_t kHeader = 64;  // in which hash and size of the rest stand from byte 32 on

/// Patches of three kinds.
const vision::OwnWordMaps& patches() {
  static const vision::OwnWordMaps made = [] {
    std::mt19937 random(3);
    vision::OwnWordMaps words(vision::word_bytes(kWords), 130);
    for (std::size_t i = 0; i < words.size(); ++i) {
      vision::WordMap map;
      for (auto& word : map) word = static_cast<vision::Word>((i + random() % 2) % kWords);
      words.set(i, map);
    }
    return words;
  }();
  return made;
}

query::FlannOptions options_of(int kind) {
  return {.kind = static_cast<query::FlannKind>(kind), .trees = 2, .branching = 4, .checks = 20};
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  fuzz::Data data(bytes, size);
  const int kind = fuzz::take(data) % 3;
  const query::FlannOptions options = options_of(kind);
  static const std::array built{query::FlannIndex(patches(), kWords, options_of(0)).serialize(),
                                query::FlannIndex(patches(), kWords, options_of(1)).serialize(),
                                query::FlannIndex(patches(), kWords, options_of(2)).serialize()};
  std::vector<std::byte> sealed(built[static_cast<std::size_t>(kind)]);
  sealed.resize(kHeader);
  sealed.insert(sealed.end(), fuzz::bytes_of(data).begin(), fuzz::bytes_of(data).end());
  const std::uint64_t length = data.size(), hash = XXH3_64bits(data.data(), data.size());
  std::memcpy(&sealed[32], &hash, sizeof hash);
  std::memcpy(&sealed[40], &length, sizeof length);
  fuzz::allow_errors([&] {
    const query::FlannIndex index(patches(), kWords, sealed, options);
    query::PieceQuery query;
    query.words = patches()[7];
    const auto found = index.search(std::vector{query}, 10);
    fuzz::expect(found[0].size() == 10, "as many rows are found as there are, whatever the trees are");
  });
  return 0;
}
