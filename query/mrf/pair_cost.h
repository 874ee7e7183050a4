// query/mrf/pair_cost.h — a cost of two labels in half the bytes of a float.
#pragma once

#include <bit>
#include <cstdint>

namespace freshet::query {

/// 7 bits of exponent, 9 of mantissa, no sign: 0, and 2^-62 to 2^65 to a thousandth of the value. Smaller
/// values count as 0, larger ones as the maximum. Minimising reads all tables again and again and waits for
/// memory: half the bytes are more than twice the speed. Energies of real pictures lose nothing by it
/// (docs/measurements/labelling.md). IEEE's 16-bit float ends at 65504, and wants instructions for it.
class PairCost {
 public:
  PairCost() = default;
  /// The nearest. cost   >= 0.
  PairCost(float cost) {
    const float minimum = 0x1p-62f, maximum = 0x1.ff8p64f;
    const float bounded = cost < minimum ? 0 : cost < maximum ? cost : maximum;
    const auto bits = std::bit_cast<std::uint32_t>(bounded * kIn);
    bits_ =
        static_cast<std::uint16_t>((bits + ((1u << (kShift - 1)) - 1) + ((bits >> kShift) & 1)) >> kShift);
  }
  operator float() const { return std::bit_cast<float>(std::uint32_t{bits_} << kShift) * kOut; }
  bool operator==(const PairCost& other) const { return bits_ == other.bits_; }

  static constexpr int kShift = 14;  // to a float whose exponent is 64 too small
  static constexpr float kIn = 0x1p-64f, kOut = 0x1p64f;

 private:
  std::uint16_t bits_;
};
static_assert(sizeof(PairCost) == 2);

}  // namespace freshet::query
