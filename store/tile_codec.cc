#include "store/tile_codec.h"

#include <algorithm>
#include <cstdlib>

#include "store/symbol_streams.h"

namespace freshet::store {
namespace {

constexpr std::uint32_t kBlock = 8;  // samples an edge of the blocks that choose their predictor

// How a sample is predicted from those before it: N above, W left, NW, and P, PN, PW, PNW in the frame
// before.
enum class Predictor : std::uint8_t {
  kSpatial = 0,   // MED of W, N, N + W - NW
  kTemporal = 1,  // P
  kDrift = 2,     // P + MED of the differences to the frame before
  kHalf = 3,      // P + half the mean difference of W and N
  kMean = 4,      // mean of kSpatial and P
  kCopy = 5,      // P, and every residual of the block is zero and absent
};
constexpr std::size_t kPredictors = 5;  // those with residuals

int med(int w, int n, int nw) {
  const int low = std::min(w, n), high = std::max(w, n);
  return std::clamp(w + n - nw, low, high);
}

// `now` and `before` point at the sample and at its place in the frame before; rows are `pitch` apart.
template <Predictor kKind, class Sample>
int predict(const Sample* now, const Sample* before, std::ptrdiff_t pitch, int w) {
  const int n = now[-pitch], nw = now[-pitch - 1];
  switch (kKind) {
    case Predictor::kSpatial:
      return med(w, n, nw);
    case Predictor::kTemporal:
      return before[0];
    case Predictor::kDrift:
      return before[0] + med(w - before[-1], n - before[-pitch], nw - before[-pitch - 1]);
    case Predictor::kHalf:
      return before[0] + ((w - before[-1] + n - before[-pitch]) >> 2);
    case Predictor::kMean:
      return (med(w, n, nw) + before[0]) >> 1;
    case Predictor::kCopy:
      return before[0];
  }
  return 0;
}

template <class Sample>
std::uint16_t zigzag(int residual) {
  if constexpr (sizeof(Sample) == 1) {
    const int e = static_cast<std::int8_t>(residual);
    return static_cast<std::uint8_t>(e * 2 ^ e >> 7);
  } else {
    const int e = static_cast<std::int16_t>(residual);
    return static_cast<std::uint16_t>(e * 2 ^ e >> 15);
  }
}

constexpr int kActivities = 8 * 255 + 1;

// Contexts are of about equal ratio in activity: finer ones gain nothing, zstd's tables eat it.
struct ContextTable {
  std::uint8_t of[kActivities];
  constexpr ContextTable() : of() {
    constexpr int kFrom[kContexts] = {0, 1, 3, 5, 7, 10, 14, 19, 26, 36, 50, 70, 98, 140, 200, 320};
    int c = 0;
    for (int a = 0; a < kActivities; ++a) {
      while (c + 1 < static_cast<int>(kContexts) && a >= kFrom[c + 1]) ++c;
      of[a] = static_cast<std::uint8_t>(c);
    }
  }
};
constexpr ContextTable kContextTable;

// A tile being coded: its samples with a border of one zero column on both sides and one zero row above each
// frame, and the size of the residuals beside them.
template <class Sample>
struct Canvas {
  explicit Canvas(const TileBox& tile)
      : box(tile),
        pitch(static_cast<std::ptrdiff_t>(tile.width) + 2),
        frame((static_cast<std::ptrdiff_t>(tile.height) + 1) * pitch),
        blocks_across((tile.width + kBlock - 1) / kBlock),
        blocks_down((tile.height + kBlock - 1) / kBlock) {
    // One empty frame in front: what the first one is predicted from.
    const auto size = static_cast<std::size_t>(frame * (tile.frames + 1) + pitch);
    samples_.assign(size, 0);
    sizes_.assign(size, 0);
  }
  Sample* row(std::uint32_t f, std::uint32_t y) { return samples_.data() + offset(f, y); }
  std::uint8_t* sizes(std::uint32_t f, std::uint32_t y) { return sizes_.data() + offset(f, y); }
  std::ptrdiff_t offset(std::uint32_t f, std::uint32_t y) const {
    return (static_cast<std::ptrdiff_t>(f) + 1) * frame + (static_cast<std::ptrdiff_t>(y) + 1) * pitch + 1;
  }
  // What precedes a row's first sample: the sample above it.
  void border(std::uint32_t f, std::uint32_t y) { row(f, y)[-1] = row(f, y)[-pitch]; }

  // Activity of a row as far as it is known before the row.
  void activity(std::uint32_t f, std::uint32_t y, std::uint16_t* out) {
    const std::uint8_t* above = sizes(f, y) - pitch;
    const std::uint8_t* before = sizes(f, y) - frame;
    for (std::uint32_t x = 0; x < box.width; ++x) {
      out[x] = static_cast<std::uint16_t>(2 * above[x] + above[x + 1] + *(above + x - 1) + 2 * before[x]);
    }
  }

  const TileBox& box;
  std::ptrdiff_t pitch, frame;
  std::uint32_t blocks_across, blocks_down;

 private:
  // Kept by the thread: tiles are many and allocation is not free.
  static inline thread_local std::vector<Sample> samples_;
  static inline thread_local std::vector<std::uint8_t> sizes_;
};

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

// A measure of the bits of a symbol, in 1/8 bit: log2 of its size and a little.
struct CostTable {
  std::uint8_t of[256];
  constexpr CostTable() : of() {
    for (int z = 0; z < 256; ++z) {
      int eighths = 0;
      // 8 log2(1 + z), by repeated squaring of (1 + z) / 2^k.
      double value = 1.0 + z;
      while (value >= 2.0) value /= 2.0, eighths += 8;
      for (int bit = 4; bit >= 1; bit /= 2) {
        value *= value;
        if (value >= 2.0) value /= 2.0, eighths += bit;
      }
      of[z] = static_cast<std::uint8_t>(z == 0 ? 2 : eighths * 2 > 255 ? 255 : 4 + eighths);
    }
  }
};
constexpr CostTable kCost;

template <Predictor kKind, class Sample>
std::uint32_t block_cost(Canvas<Sample>& canvas, std::uint32_t f, std::uint32_t x0, std::uint32_t y0,
                         bool& all_zero) {
  const std::uint32_t x1 = std::min(x0 + kBlock, canvas.box.width),
                      y1 = std::min(y0 + kBlock, canvas.box.height);
  std::uint32_t cost = 0, seen = 0;
  for (std::uint32_t y = y0; y < y1; ++y) {
    const Sample* now = canvas.row(f, y);
    const Sample* before = now - canvas.frame;
    for (std::uint32_t x = x0; x < x1; ++x) {
      const auto z =
          zigzag<Sample>(now[x] - predict<kKind>(now + x, before + x, canvas.pitch, *(now + x - 1)));
      seen |= z;
      cost += kCost.of[std::min<std::uint16_t>(z, 255)];
    }
  }
  all_zero = seen == 0;
  return cost;
}

template <class Sample>
Predictor choose(Canvas<Sample>& canvas, std::uint32_t f, std::uint32_t x0, std::uint32_t y0) {
  bool zero = false, ignored = false;
  std::array<std::uint32_t, kPredictors> cost;
  cost.fill(UINT32_MAX);
  if (f > 0) {
    cost[1] = block_cost<Predictor::kTemporal>(canvas, f, x0, y0, zero);
    if (zero) return Predictor::kCopy;
    cost[2] = block_cost<Predictor::kDrift>(canvas, f, x0, y0, ignored);
    cost[3] = block_cost<Predictor::kHalf>(canvas, f, x0, y0, ignored);
    cost[4] = block_cost<Predictor::kMean>(canvas, f, x0, y0, ignored);
    cost[0] = block_cost<Predictor::kSpatial>(canvas, f, x0, y0, ignored);
  } else {
    return Predictor::kSpatial;
  }
  return static_cast<Predictor>(std::ranges::min_element(cost) - cost.begin());
}

template <class Sample>
void encode(const TileBox& box, ByteSpan bytes, Bytes& out) {
  const std::span<const Sample> source(reinterpret_cast<const Sample*>(bytes.data()), box.samples());
  Canvas<Sample> canvas(box);
  const bool is_signed = better_signed(source);
  const auto turn = static_cast<Sample>(is_signed ? kSignBit : 0);
  for (std::uint32_t f = 0; f < box.frames; ++f) {
    for (std::uint32_t y = 0; y < box.height; ++y) {
      Sample* row = canvas.row(f, y);
      const Sample* from = source.data() + (std::size_t{f} * box.height + y) * box.width;
      for (std::uint32_t x = 0; x < box.width; ++x) row[x] = from[x] ^ turn;
      canvas.border(f, y);
    }
  }

  thread_local ContextSymbols symbols;
  for (auto& context : symbols) context.clear();
  Bytes side{static_cast<std::byte>(is_signed ? kSignedTile : kPlainTile)};
  Bytes large;
  std::vector<std::uint16_t> activity(box.width);
  std::vector<Predictor> choice(canvas.blocks_across);
  for (std::uint32_t f = 0; f < box.frames; ++f) {
    for (std::uint32_t y = 0; y < box.height; ++y) {
      if (y % kBlock == 0) {
        for (std::uint32_t b = 0; b < canvas.blocks_across; ++b) {
          choice[b] = choose(canvas, f, b * kBlock, y);
          side.push_back(static_cast<std::byte>(choice[b]));
        }
      }
      canvas.activity(f, y, activity.data());
      const Sample* now = canvas.row(f, y);
      const Sample* before = now - canvas.frame;
      std::uint8_t* sizes = canvas.sizes(f, y);
      int left = 0;  // size of the residual to the left
      for (std::uint32_t x = 0; x < box.width; ++x) {
        const Predictor predictor = choice[x / kBlock];
        if (predictor == Predictor::kCopy) {
          left = 0;
          continue;
        }
        const int w = *(now + x - 1);
        int p = 0;
        switch (predictor) {
          case Predictor::kSpatial:
            p = predict<Predictor::kSpatial>(now + x, before + x, canvas.pitch, w);
            break;
          case Predictor::kTemporal:
            p = predict<Predictor::kTemporal>(now + x, before + x, canvas.pitch, w);
            break;
          case Predictor::kDrift:
            p = predict<Predictor::kDrift>(now + x, before + x, canvas.pitch, w);
            break;
          case Predictor::kHalf:
            p = predict<Predictor::kHalf>(now + x, before + x, canvas.pitch, w);
            break;
          case Predictor::kMean:
            p = predict<Predictor::kMean>(now + x, before + x, canvas.pitch, w);
            break;
          case Predictor::kCopy:
            break;
        }
        const std::uint16_t z = zigzag<Sample>(now[x] - p);
        const auto symbol = static_cast<std::uint8_t>(std::min<std::uint16_t>(z, 255));
        symbols[kContextTable.of[activity[x] + 2 * left]].push_back(symbol);
        if (sizeof(Sample) == 2 && symbol == 255) append(large, z);
        sizes[x] = symbol;
        left = symbol;
      }
    }
  }
  side.insert(side.end(), large.begin(), large.end());
  encode_symbols(symbols, side, out);
}

// The samples of one row in one block.
template <Predictor kKind, class Sample>
void decode_run(Sample* now, const Sample* before, std::ptrdiff_t pitch, std::uint32_t count,
                const std::uint16_t* activity, std::uint8_t* sizes, DecodedSymbols& symbols, ByteSpan& large,
                int& left) {
  int w = *(now - 1), last = left;
  for (std::uint32_t x = 0; x < count; ++x) {
    unsigned z = *symbols.next[kContextTable.of[activity[x] + 2 * last]]++;
    last = static_cast<int>(z);
    sizes[x] = static_cast<std::uint8_t>(z);
    if constexpr (sizeof(Sample) == 2) {
      if (z == 255) {
        if (large.size() >= 2) {
          z = load<std::uint16_t>(large.data());
          large = large.subspan(2);
        }
      }
    }
    const int e = static_cast<int>(z >> 1) ^ -static_cast<int>(z & 1);
    now[x] = static_cast<Sample>(predict<kKind>(now + x, before + x, pitch, w) + e);
    w = now[x];
  }
  left = last;
}

template <class Sample>
bool decode(const TileBox& box, ByteSpan coded, std::span<std::byte> bytes) {
  Canvas<Sample> canvas(box);
  const std::size_t choices = std::size_t{canvas.blocks_across} * canvas.blocks_down * box.frames;
  DecodedSymbols symbols;
  if (!decode_symbols(coded, box.samples(), 1 + choices + 2 * box.samples(), symbols)) return false;
  if (symbols.side.size() < 1 + choices) return false;
  const auto kind = static_cast<std::uint8_t>(symbols.side[0]);
  if (kind > (sizeof(Sample) == 2 ? kSignedTile : kPlainTile)) return false;
  const auto turn = static_cast<Sample>(kind == kSignedTile ? kSignBit : 0);
  const std::byte* choice = symbols.side.data() + 1;
  ByteSpan large = symbols.side.subspan(1 + choices);

  std::vector<std::uint16_t> activity(box.width);
  auto* out = reinterpret_cast<Sample*>(bytes.data());
  for (std::uint32_t f = 0; f < box.frames; ++f) {
    for (std::uint32_t y = 0; y < box.height; ++y) {
      const std::byte* row_choice =
          choice + (std::size_t{f} * canvas.blocks_down + y / kBlock) * canvas.blocks_across;
      canvas.border(f, y);
      canvas.activity(f, y, activity.data());
      Sample* now = canvas.row(f, y);
      const Sample* before = now - canvas.frame;
      std::uint8_t* sizes = canvas.sizes(f, y);
      int left = 0;
      for (std::uint32_t x = 0; x < box.width; x += kBlock) {
        const std::uint32_t count = std::min(kBlock, box.width - x);
        const auto run = [&]<Predictor kKind>() {
          decode_run<kKind>(now + x, before + x, canvas.pitch, count, activity.data() + x, sizes + x, symbols,
                            large, left);
        };
        switch (static_cast<Predictor>(row_choice[x / kBlock])) {
          case Predictor::kSpatial:
            run.template operator()<Predictor::kSpatial>();
            break;
          case Predictor::kTemporal:
            run.template operator()<Predictor::kTemporal>();
            break;
          case Predictor::kDrift:
            run.template operator()<Predictor::kDrift>();
            break;
          case Predictor::kHalf:
            run.template operator()<Predictor::kHalf>();
            break;
          case Predictor::kMean:
            run.template operator()<Predictor::kMean>();
            break;
          case Predictor::kCopy:
            std::copy(before + x, before + x + count, now + x);
            left = 0;
            break;
          default:
            return false;
        }
      }
      for (std::uint32_t x = 0; x < box.width; ++x) *out++ = now[x] ^ turn;
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
