#include "store/codec/tile_codec.h"

#include <algorithm>
#include <array>

#include "store/codec/block_predictor.h"
#include "store/codec/symbol_streams.h"

namespace freshet::store {
namespace {

// Symbols share a context by groups of 8 in a row of a block. A symbol's own context would cost the decoder a
// chain from each to the next, and does not pay: over eight clips it takes 1.1 % more bytes, because what
// lies side by side is packed and matched together.
constexpr std::uint32_t kGroup = kBlock;
constexpr std::uint8_t kLargeSymbol = 255;  // 16-bit residuals from here on go to the side information

constexpr std::size_t kActivities = kGroup * kLargeSymbol + 1;

// Contexts are of about equal ratio in activity: finer ones gain nothing, zstd's tables eat it.
struct ContextTable {
  std::uint8_t of[kActivities];
  constexpr ContextTable() : of() {
    constexpr std::size_t kFrom[kContexts] = {0, 1, 3, 5, 7, 10, 14, 19, 26, 36, 50, 70, 98, 140, 200, 320};
    std::size_t c = 0;
    for (std::size_t a = 0; a < kActivities; ++a) {
      while (c + 1 < kContexts && a >= kFrom[c + 1]) ++c;
      of[a] = static_cast<std::uint8_t>(c);
    }
  }
};
constexpr ContextTable kContextTable;

/// The contexts of a tile's groups: from the sums of the symbols of the groups around, as far as rows above
/// and the frame before have them.
class GroupContexts {
 public:
  void begin(const TileBox& box) {
    groups_ = (box.width + kGroup - 1) / kGroup;
    height_ = box.height;
    pitch_ = groups_ + 2;
    frame_ = 0;
    for (auto& sums : sums_) sums.assign(std::size_t{height_} * pitch_, 0);
    nothing_.assign(pitch_, 0);
    contexts_.resize(groups_);
  }
  std::uint32_t groups() const { return groups_; }

  /// Contexts of a row. All rows, in order.
  std::span<const std::uint8_t> of_row(std::uint32_t f, std::uint32_t y) {
    frame_ = f;
    const std::uint16_t* p = f > 0 ? row(f - 1, y) : nullptr;
    const std::uint16_t* ps = p != nullptr && y + 1 < height_ ? p + pitch_ : p;
    const std::uint16_t* n = y > 0 ? row(f, y - 1) : p != nullptr ? p : nothing_.data() + 1;
    const std::uint16_t* nn = y > 1 ? n - pitch_ : n;
    if (p == nullptr) p = ps = n;
    for (std::uint32_t g = 0; g < groups_; ++g) {
      const unsigned weighted = 6u * n[g] + *(n + g - 1) + n[g + 1] + 4u * nn[g] + 2u * p[g] + 2u * ps[g];
      contexts_[g] = kContextTable.of[weighted >> 4];
    }
    return contexts_;
  }

  /// The sums of the row's groups, to be filled in; followed by close_row().
  std::uint16_t* sums(std::uint32_t y) { return row(frame_, y); }
  void close_row(std::uint32_t y) {
    std::uint16_t* sums = row(frame_, y);
    *(sums - 1) = sums[0];
    sums[groups_] = sums[groups_ - 1];
  }

 private:
  std::uint16_t* row(std::uint32_t f, std::uint32_t y) {
    return sums_[f & 1].data() + std::size_t{y} * pitch_ + 1;
  }
  std::uint32_t groups_ = 0, height_ = 0, frame_ = 0;
  std::size_t pitch_ = 0;
  std::array<std::vector<std::uint16_t>, 2> sums_;  // of this frame's groups and the last one's
  std::vector<std::uint16_t> nothing_;
  std::vector<std::uint8_t> contexts_;
};

std::uint64_t load_group(const std::uint8_t* from) {
  std::uint64_t group;
  std::memcpy(&group, from, sizeof group);
  return group;
}

// Sum of the 8 bytes.
std::uint16_t sum_of(std::uint64_t group) {
  constexpr std::uint64_t kEven = 0x00ff00ff00ff00ff, kOnes = 0x0001000100010001;
  return static_cast<std::uint16_t>(((group & kEven) + (group >> 8 & kEven)) * kOnes >> 48);
}

std::uint64_t first_bytes(std::uint32_t count) {
  return count == kGroup ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * count) - 1;
}

// Signed 16-bit samples (flow) cross zero: with the top bit turned they do not wrap in the middle.
constexpr std::uint16_t kSignBit = 0x8000;
constexpr std::uint8_t kPlainTile = 0, kSignedTile = 1;

template <class Sample>
bool better_signed(std::span<const Sample> samples) {
  if constexpr (sizeof(Sample) == 1) return false;
  const auto [low, high] = std::ranges::minmax(samples);
  Sample signed_low = static_cast<Sample>(-1), signed_high = 0;
  for (const Sample sample : samples) {
    const auto turned = static_cast<Sample>(sample ^ kSignBit);
    signed_low = std::min(signed_low, turned);
    signed_high = std::max(signed_high, turned);
  }
  return signed_high - signed_low < high - low;
}

// Symbols by context, each context's memory long enough for all of them.
class SymbolSorter {
 public:
  void begin(std::size_t symbols) {
    each_ = symbols + kGroup;
    if (memory_.size() < kContexts * each_) memory_.resize(kContexts * each_);
    for (std::size_t c = 0; c < kContexts; ++c) end_[c] = memory_.data() + c * each_;
  }
  void add(std::uint8_t context, std::uint64_t group, std::uint32_t count) {
    std::memcpy(end_[context], &group, sizeof group);
    end_[context] += count;
  }
  ContextSymbols symbols() const {
    ContextSymbols symbols;
    for (std::size_t c = 0; c < kContexts; ++c) symbols[c] = {memory_.data() + c * each_, end_[c]};
    return symbols;
  }

 private:
  std::vector<std::uint8_t> memory_;
  std::size_t each_ = 0;
  std::array<std::uint8_t*, kContexts> end_{};
};

template <class Sample>
void encode(const TileBox& box, ByteSpan bytes, Bytes& out) {
  const std::span<const Sample> source(reinterpret_cast<const Sample*>(bytes.data()), box.samples());
  const bool is_signed = better_signed(source);
  const auto turn = static_cast<Sample>(is_signed ? kSignBit : 0);
  const std::size_t frame_samples = std::size_t{box.width} * box.height;

  // Kept by the thread: tiles are many and allocation is not free.
  thread_local StripPredictor<Sample> predictor;
  thread_local GroupContexts contexts;
  thread_local SymbolSorter sorter;
  thread_local std::vector<Predictor> choices;
  thread_local Bytes side, large;
  predictor.begin(box.width, box.height);
  contexts.begin(box);
  sorter.begin(box.samples());
  choices.resize(contexts.groups());
  side.assign(1, static_cast<std::byte>(is_signed ? kSignedTile : kPlainTile));
  large.clear();

  for (std::uint32_t f = 0; f < box.frames; ++f) {
    predictor.next_frame(source.subspan(f * frame_samples, frame_samples), turn);
    for (std::uint32_t y = 0; y < box.height; ++y) {
      if (y % kBlock == 0) {
        predictor.predict(y / kBlock, choices);
        for (const Predictor choice : choices) side.push_back(static_cast<std::byte>(choice));
      }
      const std::span<const std::uint8_t> context = contexts.of_row(f, y);
      std::uint16_t* sums = contexts.sums(y);
      const Sample* residuals = predictor.residuals(y % kBlock);
      for (std::uint32_t g = 0; g < contexts.groups(); ++g) {
        sums[g] = 0;
        if (choices[g] == Predictor::kCopy) continue;
        const std::uint32_t x = g * kGroup, count = std::min(kGroup, box.width - x);
        std::uint8_t symbols[kGroup] = {};
        for (std::uint32_t i = 0; i < count; ++i) {
          const Sample z = residuals[x + i];
          symbols[i] = static_cast<std::uint8_t>(std::min<Sample>(z, kLargeSymbol));
          if (sizeof(Sample) == 2 && symbols[i] == kLargeSymbol) append(large, static_cast<std::uint16_t>(z));
        }
        const std::uint64_t group = load_group(symbols);
        sums[g] = sum_of(group);
        sorter.add(context[g], group, count);
      }
      contexts.close_row(y);
    }
  }
  side.insert(side.end(), large.begin(), large.end());
  encode_symbols(sorter.symbols(), side, out);
}

// Takes the large residuals' values from the side information. False when it has too few.
bool take_large(std::uint16_t* residuals, std::uint32_t count, ByteSpan& large) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (residuals[i] != kLargeSymbol) continue;
    if (large.size() < 2) return false;
    residuals[i] = load<std::uint16_t>(large.data());
    large = large.subspan(2);
  }
  return true;
}

template <class Sample>
bool decode(const TileBox& box, ByteSpan coded, std::span<std::byte> bytes) {
  thread_local StripRestorer<Sample> restorer;
  thread_local GroupContexts contexts;
  contexts.begin(box);
  const std::uint32_t across = contexts.groups(), down = (box.height + kBlock - 1) / kBlock;
  const std::size_t choice_count = std::size_t{across} * down * box.frames;
  DecodedSymbols symbols;
  if (!decode_symbols(coded, box.samples(), 1 + choice_count + 2 * box.samples(), symbols)) return false;
  if (symbols.side.size() < 1 + choice_count) return false;
  const auto kind = static_cast<std::uint8_t>(symbols.side[0]);
  if (kind > (sizeof(Sample) == 2 ? kSignedTile : kPlainTile)) return false;
  const auto turn = static_cast<Sample>(kind == kSignedTile ? kSignBit : 0);
  std::span<const Predictor> choices(reinterpret_cast<const Predictor*>(symbols.side.data() + 1),
                                     choice_count);
  if (std::ranges::any_of(choices, [](Predictor choice) { return choice > Predictor::kCopy; })) return false;
  ByteSpan large = symbols.side.subspan(1 + choice_count);

  restorer.begin(box.width, box.height);
  auto* out = reinterpret_cast<Sample*>(bytes.data());
  for (std::uint32_t f = 0; f < box.frames; ++f) {
    restorer.next_frame();
    for (std::uint32_t strip = 0; strip < down; ++strip, choices = choices.subspan(across)) {
      const std::uint32_t rows = std::min(kBlock, box.height - strip * kBlock);
      for (std::uint32_t row = 0; row < rows; ++row) {
        const std::uint32_t y = strip * kBlock + row;
        const std::span<const std::uint8_t> context = contexts.of_row(f, y);
        std::uint16_t* sums = contexts.sums(y);
        Sample* residuals = restorer.residuals(row);
        for (std::uint32_t g = 0; g < across; ++g) {
          std::uint64_t group = 0;
          const std::uint32_t count = std::min(kGroup, box.width - g * kGroup);
          if (choices[g] != Predictor::kCopy) {
            const std::uint8_t*& next = symbols.next[context[g]];
            group = load_group(next) & first_bytes(count);
            next += count;
          }
          sums[g] = sum_of(group);
          if constexpr (sizeof(Sample) == 1) {
            std::memcpy(residuals + g * kGroup, &group, sizeof group);
          } else {
            for (std::uint32_t i = 0; i < kGroup; ++i) {
              residuals[g * kGroup + i] = static_cast<Sample>(group >> 8 * i & 255);
            }
            if (sums[g] >= kLargeSymbol && !take_large(residuals + g * kGroup, count, large)) return false;
          }
        }
        contexts.close_row(y);
      }
      restorer.restore(strip, choices.first(across));
      for (std::uint32_t row = 0; row < rows; ++row, out += box.width) {
        const Sample* samples = restorer.samples(row);
        for (std::uint32_t x = 0; x < box.width; ++x) out[x] = samples[x] ^ turn;
      }
    }
  }
  return symbols.finished() && large.empty();
}

}  // namespace

void encode_tile(const TileBox& box, ByteSpan samples, Bytes& out) {
  if (box.bytes_per_sample == 1) {
    encode<std::uint8_t>(box, samples, out);
  } else {
    encode<std::uint16_t>(box, samples, out);
  }
}

bool decode_tile(const TileBox& box, ByteSpan coded, std::span<std::byte> samples) {
  if (samples.size() != box.bytes()) return false;
  return box.bytes_per_sample == 1 ? decode<std::uint8_t>(box, coded, samples)
                                   : decode<std::uint16_t>(box, coded, samples);
}

}  // namespace freshet::store
