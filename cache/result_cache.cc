#include "cache/result_cache.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "freshet/error.h"
#include "platform/text.h"

namespace freshet::cache {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".labels";
constexpr const char* kUnfinished = ".freshet-new-";
constexpr std::size_t kNameDigits = 32;

/// By its name: 32 hex digits and the ending. Whatever else lies in a folder is somebody else's.
bool is_ours(const fs::path& path) {
  const std::string stem = path.stem().string();
  return path.extension() == kEnding && stem.size() == kNameDigits &&
         stem.find_first_not_of("0123456789abcdef") == std::string::npos;
}
constexpr std::size_t kMaxPacks = 256;
constexpr std::array<char, 8> kMagic{'F', 'R', 'E', 'L', 'A', 'B', 'E', 'L'};
// Raised when what is kept, or how it is computed, changes: older packs are then as good as none.
constexpr std::uint32_t kVersion = 4;

// Little endian, as on every machine that we run on.
struct Header {
  std::array<char, 8> magic = kMagic;
  std::uint32_t version = kVersion, entries = 0;
  std::uint64_t directory = 0;       // its offset; it reaches to the end
  std::uint64_t directory_hash = 0;  // XXH3-64
};
static_assert(sizeof(Header) == 32);

struct DirectoryEntry {
  Key key;
  std::uint64_t offset, length, hash;
};
static_assert(sizeof(DirectoryEntry) == 40);

// Binds the bytes to their key: a whole but misplaced entry is found out.
std::uint64_t hash_of(const Key& key, std::span<const std::byte> bytes) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), key.high ^ key.low);
}

bool read_at(int file, std::uint64_t offset, std::span<std::byte> out) {
  while (!out.empty()) {
    const ssize_t got = pread(file, out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
  return true;
}

bool write_at(int file, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t put = pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    offset += static_cast<std::uint64_t>(put);
    bytes = bytes.subspan(static_cast<std::size_t>(put));
  }
  return true;
}

}  // namespace

std::string hex(const Key& key) { return freshet::hex(key.high) + freshet::hex(key.low); }

struct KeyHash::State {
  XXH3_state_t* state = XXH3_createState();
  ~State() { XXH3_freeState(state); }
};

KeyHash::KeyHash() : state_(std::make_unique<State>()) { XXH3_128bits_reset(state_->state); }
KeyHash::KeyHash(KeyHash&&) noexcept = default;
KeyHash::~KeyHash() = default;
void KeyHash::bytes(std::span<const std::byte> bytes) {
  XXH3_128bits_update(state_->state, bytes.data(), bytes.size());
}
Key KeyHash::key() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_->state);
  return {hash.high64, hash.low64};
}

// A file, open as long as this lives.
struct ResultCache::Pack {
  fs::path path;
  int file = -1;
  std::uint64_t size = 0;
  bool used = false;  // by this run
  ~Pack() {
    if (file >= 0) close(file);
  }
};

ResultCache::ResultCache(const fs::path& folder, std::uintmax_t max_bytes)
    : folder_(folder), max_bytes_(max_bytes) {
  std::error_code fault;
  fs::create_directories(folder, fault);
  if (fault || !fs::is_directory(folder))
    throw Error(ErrorKind::kIo, folder.string(), "no folder for a cache can be made here",
                "Give another with --cache");
  std::vector<fs::path> paths;
  for (auto entry = fs::directory_iterator(folder, fault); !fault && entry != fs::directory_iterator();
       entry.increment(fault))
    if (is_ours(entry->path())) paths.push_back(entry->path());
  if (fault) throw Error(ErrorKind::kIo, folder.string(), "it cannot be read: " + fault.message());
  std::sort(paths.begin(), paths.end());
  for (const fs::path& path : paths) open(path);
}

ResultCache::~ResultCache() {
  try {
    finish();
  } catch (...) {
    // Nothing was promised.
  }
}

void ResultCache::open(const fs::path& path) {
  auto pack = std::make_unique<Pack>();
  pack->path = path;
  pack->file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (pack->file < 0) return;  // another process has removed it, or there is no right or room to read it now
  Header header;
  struct stat status {};
  std::vector<DirectoryEntry> directory;
  const auto is_whole = [&] {
    if (pack->file < 0 || fstat(pack->file, &status) != 0 || !S_ISREG(status.st_mode)) return false;
    pack->size = static_cast<std::uint64_t>(status.st_size);
    if (!read_at(pack->file, 0, std::as_writable_bytes(std::span(&header, 1)))) return false;
    if (header.magic != kMagic || header.version != kVersion || header.directory > pack->size) return false;
    if (pack->size - header.directory != header.entries * sizeof(DirectoryEntry)) return false;
    directory.resize(header.entries);
    const auto bytes = std::as_writable_bytes(std::span(directory));
    if (!read_at(pack->file, header.directory, bytes)) return false;
    if (XXH3_64bits(bytes.data(), bytes.size()) != header.directory_hash) return false;
    return std::all_of(directory.begin(), directory.end(), [&](const DirectoryEntry& entry) {
      return entry.offset <= header.directory && entry.length <= header.directory - entry.offset;
    });
  };
  if (!is_whole()) {
    notices_.push_back(path.string() + ": damaged, or of another version; left out of the cache");
    damaged_.push_back(path);
    return;
  }
  for (const DirectoryEntry& entry : directory)
    places_[entry.key] = {packs_.size(), {entry.offset, entry.length, entry.hash}};
  packs_.push_back(std::move(pack));
}

std::optional<std::vector<std::byte>> ResultCache::find(const Key& key) {
  const std::lock_guard lock(guard_);
  const Pack* pack = nullptr;
  Entry entry;
  if (const auto own = added_.find(key); own != added_.end()) {
    pack = own_.get();
    entry = own->second;
  } else if (const auto place = places_.find(key); place != places_.end()) {
    packs_[place->second.pack]->used = true;
    pack = packs_[place->second.pack].get();
    entry = place->second.entry;
  }
  if (pack == nullptr) return std::nullopt;
  std::vector<std::byte> bytes(entry.length);
  if (read_at(pack->file, entry.offset, bytes) && hash_of(key, bytes) == entry.hash) return bytes;
  // The rest of its pack may be whole; this entry will be computed, and kept again.
  notices_.push_back(pack->path.string() + ": an entry is damaged; left out of the cache");
  if (pack != own_.get()) damaged_.push_back(pack->path);
  places_.erase(key);
  return std::nullopt;
}

void ResultCache::give_up(const std::string& why) {
  notices_.push_back(folder_.string() + ": nothing more is kept there: " + why);
  given_up_ = true;
}

void ResultCache::keep(const Key& key, std::span<const std::byte> bytes) {
  const std::lock_guard lock(guard_);
  if (given_up_ || added_.contains(key) || places_.contains(key)) return;
  if (!own_) {
    std::string name = (folder_ / (std::string(kUnfinished) + "XXXXXX")).string();
    auto pack = std::make_unique<Pack>();
    pack->file = mkostemp(name.data(), O_CLOEXEC);
    if (pack->file < 0) return give_up(std::strerror(errno));
    pack->path = name;
    pack->size = sizeof(Header);
    own_ = std::move(pack);
  }
  if (own_->size + bytes.size() > max_bytes_)
    return give_up(fmt::format("this run alone fills its {} MB", max_bytes_ >> 20));
  if (!write_at(own_->file, own_->size, bytes)) return give_up(std::strerror(errno));
  added_[key] = {own_->size, bytes.size(), hash_of(key, bytes)};
  own_->size += bytes.size();
}

void ResultCache::finish() {
  const std::lock_guard lock(guard_);
  if (own_) {
    std::vector<DirectoryEntry> directory;
    for (const auto& [key, entry] : added_)
      directory.push_back({key, entry.offset, entry.length, entry.hash});
    const auto bytes = std::as_bytes(std::span(directory));
    Header header;
    header.entries = static_cast<std::uint32_t>(directory.size());
    header.directory = own_->size;
    header.directory_hash = XXH3_64bits(bytes.data(), bytes.size());
    const fs::path name =
        folder_ / (freshet::hex(header.directory_hash) + freshet::hex(own_->size) + kEnding);
    std::error_code fault;
    bool written = !directory.empty() && write_at(own_->file, own_->size, bytes) &&
                   write_at(own_->file, 0, std::as_bytes(std::span(&header, 1)));
    if (written) {
      fs::rename(own_->path, name, fault);
      written = !fault;
    }
    if (written) {
      own_->path = name;
      own_->size += bytes.size();
      own_->used = true;
      for (const auto& [key, entry] : added_) places_[key] = {packs_.size(), entry};
      packs_.push_back(std::move(own_));
    } else {
      if (!directory.empty()) give_up(fault ? fault.message() : std::strerror(errno));
      fs::remove(own_->path, fault);
    }
    own_.reset();
    added_.clear();
  }
  evict();
}

void ResultCache::evict() {
  std::error_code fault;  // of files that others may be removing as well
  for (const fs::path& path : std::exchange(damaged_, {})) fs::remove(path, fault);
  for (const auto& pack : packs_)
    if (pack->used) fs::last_write_time(pack->path, fs::file_time_type::clock::now(), fault);
  struct Kept {
    fs::file_time_type time;
    fs::path path;
    std::uintmax_t bytes;
  };
  std::vector<Kept> kept;
  std::uintmax_t total = 0;
  for (auto entry = fs::directory_iterator(folder_, fault); !fault && entry != fs::directory_iterator();
       entry.increment(fault)) {
    // What a killed run left behind ages like the rest.
    if (!is_ours(entry->path()) && !entry->path().filename().string().starts_with(kUnfinished)) continue;
    std::error_code gone;
    const auto time = entry->last_write_time(gone);
    const auto bytes = entry->file_size(gone);
    if (gone) continue;
    kept.push_back({time, entry->path(), bytes});
    total += bytes;
  }
  std::sort(kept.begin(), kept.end(), [](const Kept& a, const Kept& b) { return a.time < b.time; });
  std::size_t count = kept.size();
  for (const Kept& oldest : kept) {
    if (total <= max_bytes_ && count <= kMaxPacks) break;
    fs::remove(oldest.path, fault);
    total -= oldest.bytes;
    --count;
  }
}

std::vector<std::string> ResultCache::take_notices() {
  const std::lock_guard lock(guard_);
  return std::exchange(notices_, {});
}

}  // namespace freshet::cache
