#include "synth/transfer/state_file.h"

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <system_error>
#include <vector>

#include "freshet/error.h"
#include "platform/random.h"

namespace freshet::synth::transfer {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they lie in memory");
static_assert(sizeof(Pixel) == 16 && sizeof(Vec2) == 8);

struct Header {
  char tag[8] = {'F', 'R', 'T', 'R', 'A', 'N', 'S', '2'};
  std::uint64_t options = 0;
  std::int32_t frame = 0, width = 0, height = 0, unused = 0;
};
constexpr std::uint64_t kPixelBytes = sizeof(Pixel) + sizeof(float) + sizeof(Vec2) + sizeof(std::int32_t);
constexpr std::int32_t kMaxSide = 32768;

// Chained SplitMix64 over 8 bytes at a time: finds damage, keeps out nobody.
std::uint64_t hash(const char* bytes, std::size_t count) {
  std::uint64_t sum = count;
  for (std::size_t i = 0; i < count; i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + i, std::min<std::size_t>(8, count - i));
    sum = scramble(sum ^ word);
  }
  return sum;
}

// Of everything that changes a frame; the seed too, as a run that goes on with another one is another run.
std::uint64_t digest(const TransferOptions& o) {
  const double numbers[] = {o.lambda,     o.eta,         o.radius,    o.lower,     o.upper,
                            o.vote_power, o.motion_blur, o.curvature, o.divergence};
  const std::uint64_t whole[] = {
      static_cast<std::uint64_t>(o.patch),      static_cast<std::uint64_t>(o.levels),
      static_cast<std::uint64_t>(o.iterations), static_cast<std::uint64_t>(o.passes),
      static_cast<std::uint64_t>(o.retrieval),  static_cast<std::uint64_t>(o.start),
      static_cast<std::uint64_t>(o.search),     static_cast<std::uint64_t>(o.quarter_turns),
      static_cast<std::uint64_t>(o.stabilised), o.seed};
  return hash(reinterpret_cast<const char*>(numbers), sizeof numbers) ^
         scramble(hash(reinterpret_cast<const char*>(whole), sizeof whole));
}

template <typename T>
void put(std::vector<char>& to, const GridOf<T>& grid) {
  const char* bytes = reinterpret_cast<const char*>(grid.values.data());
  to.insert(to.end(), bytes, bytes + grid.values.size() * sizeof(T));
}

template <typename T>
const char* take(const char* from, int width, int height, GridOf<T>& grid) {
  grid = GridOf<T>(width, height);
  std::memcpy(static_cast<void*>(grid.values.data()), from, grid.values.size() * sizeof(T));
  return from + grid.values.size() * sizeof(T);
}

}  // namespace

void write_state(const std::filesystem::path& path, const State& state, const TransferOptions& options) {
  Header header;
  header.options = digest(options);
  header.frame = state.frame;
  header.width = state.picture.width;
  header.height = state.picture.height;
  std::vector<char> bytes(sizeof header);
  std::memcpy(bytes.data(), &header, sizeof header);
  put(bytes, state.picture);
  put(bytes, state.mask);
  put(bytes, state.flow);
  put(bytes, state.sources);
  const std::uint64_t sum = hash(bytes.data(), bytes.size());
  const std::filesystem::path draft = path.string() + ".part";
  std::ofstream file(draft, std::ios::binary | std::ios::trunc);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.write(reinterpret_cast<const char*>(&sum), sizeof sum);
  file.close();
  std::error_code failed;
  if (file.good()) std::filesystem::rename(draft, path, failed);
  if (!file.good() || failed) {
    std::error_code ignored;
    std::filesystem::remove(draft, ignored);
    throw Error(ErrorKind::kIo, path.string(), "the state could not be written",
                "Check that the folder exists and that the disk has room");
  }
}

State read_state(const std::filesystem::path& path, const TransferOptions& options) {
  const auto refuse = [&](const char* fault) {
    throw Error(ErrorKind::kInput, path.string(), fault, "Begin again from the first frame");
  };
  std::error_code failed;
  const std::uintmax_t size = std::filesystem::file_size(path, failed);
  std::ifstream file(path, std::ios::binary);
  if (failed || !file) refuse("the state cannot be read");
  Header header, expected;
  file.read(reinterpret_cast<char*>(&header), sizeof header);
  if (!file || std::memcmp(header.tag, expected.tag, sizeof header.tag) != 0)
    refuse("this is no transfer's state");
  if (header.width < 0 || header.height < 0 || header.width > kMaxSide || header.height > kMaxSide ||
      header.frame < 0)
    refuse("its size or frame is out of range");
  const std::uintmax_t pixels =
      static_cast<std::uintmax_t>(header.width) * static_cast<std::uintmax_t>(header.height);
  if (size != sizeof header + pixels * kPixelBytes + sizeof(std::uint64_t)) refuse("it is cut or too long");
  std::vector<char> bytes(size);
  file.seekg(0);
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + size - sizeof sum, sizeof sum);
  if (!file || hash(bytes.data(), size - sizeof sum) != sum) refuse("it is damaged");
  if (header.options != digest(options)) refuse("it was written with other options");
  State state;
  state.frame = header.frame;
  const char* at = bytes.data() + sizeof header;
  at = take(at, header.width, header.height, state.picture);
  at = take(at, header.width, header.height, state.mask);
  at = take(at, header.width, header.height, state.flow);
  take(at, header.width, header.height, state.sources);
  return state;
}

}  // namespace freshet::synth::transfer
