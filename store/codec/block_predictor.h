// store/codec/block_predictor.h — samples of a tile from their neighbours, a strip of 8 rows at a time.
//
// All arithmetic is vectors of 8 lanes. The encoder has every sample at hand and goes along the rows. In the
// decoder a sample waits for the one to its left and for those above. So a lane is a row there, one sample
// behind the row above it, and 8 samples of a diagonal are restored at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

namespace freshet::store {

inline constexpr std::uint32_t kBlock = 8;  // samples per edge of the blocks that choose their predictor

/// How a sample is predicted from those before it: N above, W left, NW, and P, PN, PW, PNW in the frame
/// before. docs/format.md has the formulas.
enum class Predictor : std::uint8_t {
  kSpatial = 0,   // MED of W, N, W + N - NW
  kTemporal = 1,  // P
  kDrift = 2,     // P + MED of the differences to the frame before
  kSoft = 3,      // W + N - NW with less weight: noise of three neighbours does not add up
  kMean = 4,      // mean of kSpatial and P
  kCopy = 5,      // P, and every residual of the block is zero and absent
};
inline constexpr std::size_t kPredictors = 5;  // those with residuals

/// The encoder's: residuals of a tile's samples under the best predictor of each block.
/// Sample   std::uint8_t or std::uint16_t.
template <class Sample>
class StripPredictor {
 public:
  /// Begins a tile. Memory is kept from tile to tile.
  void begin(std::uint32_t width, std::uint32_t height);
  /// Begins the next frame: its samples, rows packed, each with the bits of `turn` turned.
  void next_frame(std::span<const Sample> samples, Sample turn);
  /// Chooses the predictors of the strip of rows [8 strip, 8 strip + 8) by the sum of their residuals, one a
  /// block. Strips in any order.
  void predict(std::uint32_t strip, std::span<Predictor> choices);
  /// Row `row` < 8 of that strip: `width` residuals, as 0, 1, 2, 3, 4 .. for 0, -1, 1, -2, 2 ..
  const Sample* residuals(std::uint32_t row) const { return best_.data() + row * pitch_; }

 private:
  using Wide = std::conditional_t<sizeof(Sample) == 1, std::int16_t, std::int32_t>;
  using Cost = std::conditional_t<sizeof(Sample) == 1, std::uint16_t, std::uint32_t>;
  std::uint32_t width_ = 0, height_ = 0;
  std::size_t pitch_ = 0;
  std::array<std::vector<Wide>, 2> frames_;  // with a border of one column and one row; this and the last one
  std::size_t now_ = 0;
  std::vector<Sample> candidates_, best_;  // of each predictor, 8 rows; 8 rows
  std::vector<Cost> costs_;                // of each predictor, a row
};

/// The decoder's: samples from residuals.
template <class Sample>
class StripRestorer {
 public:
  /// Begins a tile. Memory is kept from tile to tile.
  void begin(std::uint32_t width, std::uint32_t height);
  void next_frame();
  /// Where row `row` < 8 of a strip's residuals goes, `width` of them and up to the next multiple of 8
  /// whatever one likes. Blocks of kCopy have zeros.
  Sample* residuals(std::uint32_t row) { return residuals_.data() + row * pitch_ + kBlock; }
  /// Restores strip `strip`. All strips, in order.
  void restore(std::uint32_t strip, std::span<const Predictor> choices);
  /// Row `row` < 8 of the strip restored last: `width` samples.
  const Sample* samples(std::uint32_t row) const { return restored_.data() + row * pitch_ + kBlock; }

 private:
  using Wide = std::conditional_t<sizeof(Sample) == 1, std::int16_t, std::int32_t>;
  std::size_t pitch_ = 0;                    // of a row of residuals or samples
  std::size_t strip_ = 0;                    // values of a strip of diagonals
  std::array<std::vector<Wide>, 2> frames_;  // in diagonals; this and the last one
  std::size_t now_ = 0;
  std::vector<Sample> residuals_, restored_;
};

extern template class StripPredictor<std::uint8_t>;
extern template class StripPredictor<std::uint16_t>;
extern template class StripRestorer<std::uint8_t>;
extern template class StripRestorer<std::uint16_t>;

}  // namespace freshet::store
