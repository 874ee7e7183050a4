#include "stored/stored_codebook.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include "freshet/error.h"

namespace freshet::stored {
namespace {

struct Header {
  std::array<char, 8> magic{'F', 'R', 'S', 'H', 'C', 'B', 'K', '1'};
  std::uint32_t words = 0;
  std::uint32_t descriptor_size = vision::kDescriptorSize;
  std::uint64_t clips_hash = 0;
};
static_assert(sizeof(Header) == 24);

}  // namespace

std::uint64_t hash_of_clips(const store::Snapshot& snapshot) {
  std::vector<std::string> hashes;
  for (const store::ClipId clip : snapshot.clips()) hashes.push_back(snapshot.clip(clip).source_hash);
  std::sort(hashes.begin(), hashes.end());
  std::string all;
  for (const std::string& hash : hashes) all += hash + "\n";
  return XXH3_64bits(all.data(), all.size());
}

std::vector<std::byte> to_bytes(const StoredCodebook& stored) {
  Header header;
  header.words = static_cast<std::uint32_t>(stored.codebook.words);
  header.clips_hash = stored.clips_hash;
  const auto centres = std::as_bytes(std::span(stored.codebook.centres));
  std::vector<std::byte> bytes(sizeof header + centres.size());
  std::memcpy(bytes.data(), &header, sizeof header);
  std::copy(centres.begin(), centres.end(), bytes.begin() + sizeof header);
  return bytes;
}

std::optional<StoredCodebook> find_codebook(const store::Snapshot& snapshot) {
  const auto bytes = snapshot.blob(kCodebookBlob);
  if (!bytes) return std::nullopt;
  const auto fail = [](const std::string& fault) {
    throw Error(ErrorKind::kDamaged, "codebook", fault, "Build it again: freshet index --rebuild");
  };
  Header header;
  if (bytes->size() < sizeof header) fail("shorter than its header");
  std::memcpy(&header, bytes->data(), sizeof header);
  if (header.magic != Header{}.magic || header.descriptor_size != vision::kDescriptorSize) {
    fail("not a codebook of this version");
  }
  if (header.words < 1 || header.words > vision::kMaxWords)
    fail(std::to_string(header.words) + " words, 1 to " + std::to_string(vision::kMaxWords) + " expected");
  StoredCodebook stored;
  stored.codebook.words = static_cast<int>(header.words);
  stored.codebook.centres.resize(std::size_t{header.words} * vision::kDescriptorSize);
  stored.clips_hash = header.clips_hash;
  const auto centres = std::as_writable_bytes(std::span(stored.codebook.centres));
  if (bytes->size() != sizeof header + centres.size()) fail("not as long as its number of words asks for");
  std::copy(bytes->begin() + sizeof header, bytes->end(), centres.begin());
  for (const float value : stored.codebook.centres) {
    if (!std::isfinite(value)) fail("a centre that is no number");
  }
  return stored;
}

vision::Codebook read_codebook(const store::Snapshot& snapshot) {
  auto stored = find_codebook(snapshot);
  const bool fits = stored && stored->clips_hash == hash_of_clips(snapshot);
  if (!fits && snapshot.files().size() > 1) {
    throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                "the " + std::to_string(snapshot.files().size()) +
                    " stores that are searched as one have no index of all their clips",
                "Name them in a list, one a line, and run freshet index on it");
  }
  if (!stored)
    throw Error(ErrorKind::kNotFound, snapshot.path().string(), "it has no index", "Run freshet index");
  if (!fits) {
    throw Error(ErrorKind::kNotFound, snapshot.path().string(),
                "clips have been added since its index was built", "Run freshet index");
  }
  return std::move(stored->codebook);
}

}  // namespace freshet::stored
