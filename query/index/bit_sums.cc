#include "query/index/bit_sums.h"

#include <bit>
#include <cassert>
#include <cstring>

#include "platform/vectors.h"

namespace freshet::query {
namespace {

typedef std::uint64_t Lanes128 __attribute__((vector_size(16)));
typedef std::uint64_t Lanes256 __attribute__((vector_size(32)));
typedef std::uint64_t Lanes512 __attribute__((vector_size(64)));

constexpr std::size_t kAhead = 3;  // groups

// Inlined into a function for each width, whose instructions it then takes.
#define FRESHET_INLINED inline __attribute__((always_inline))

template <class Lanes>
FRESHET_INLINED void load(Lanes& to, const std::uint64_t* from) {
  std::memcpy(&to, from, sizeof to);
}
template <class Lanes>
FRESHET_INLINED void save(const Lanes& from, std::uint64_t* to) {
  std::memcpy(to, &from, sizeof from);
}

// a + b + c = sum + 2 carry; sum and carry may be among a, b and c.
template <class Lanes>
FRESHET_INLINED void full_add(Lanes& sum, Lanes& carry, const Lanes& a, const Lanes& b, const Lanes& c) {
  const Lanes odd = a ^ b, both = a & b, all = odd ^ c;
  carry = both | (odd & c);
  sum = all;
}

// Sums of up to 127 columns: seven planes. Eight columns at a time, as Harley and Seal count bits.
template <class Lanes>
FRESHET_INLINED void count(std::span<const RowBits* const> columns, std::size_t group, std::size_t word,
                           Lanes (&planes)[7]) {
  Lanes ones{}, twos{}, fours{}, p3{}, p4{}, p5{}, p6{};
  std::size_t i = 0;
  for (; i + 8 <= columns.size(); i += 8) {
    const RowBits* const* column = columns.data() + i;
    // The processor does not see so many streams by itself; what is asked for beyond the end is never read.
    if (word == 0)
      for (int k = 0; k < 8; ++k) __builtin_prefetch(&column[k][group + kAhead]);
    Lanes a, b, twos_a, twos_b, fours_a, fours_b, eights;
    load(a, &column[0][group].words[word]);
    load(b, &column[1][group].words[word]);
    full_add(ones, twos_a, ones, a, b);
    load(a, &column[2][group].words[word]);
    load(b, &column[3][group].words[word]);
    full_add(ones, twos_b, ones, a, b);
    full_add(twos, fours_a, twos, twos_a, twos_b);
    load(a, &column[4][group].words[word]);
    load(b, &column[5][group].words[word]);
    full_add(ones, twos_a, ones, a, b);
    load(a, &column[6][group].words[word]);
    load(b, &column[7][group].words[word]);
    full_add(ones, twos_b, ones, a, b);
    full_add(twos, fours_b, twos, twos_a, twos_b);
    full_add(fours, eights, fours, fours_a, fours_b);
    const Lanes c3 = p3 & eights, c4 = p4 & c3, c5 = p5 & c4;
    p3 ^= eights;
    p4 ^= c3;
    p5 ^= c4;
    p6 ^= c5;
  }
  for (; i < columns.size(); ++i) {
    Lanes a;
    load(a, &columns[i][group].words[word]);
    const Lanes c0 = ones & a, c1 = twos & c0, c2 = fours & c1, c3 = p3 & c2, c4 = p4 & c3, c5 = p5 & c4;
    ones ^= a;
    twos ^= c0;
    fours ^= c1;
    p3 ^= c2;
    p4 ^= c3;
    p5 ^= c4;
    p6 ^= c5;
  }
  planes[0] = ones;
  planes[1] = twos;
  planes[2] = fours;
  planes[3] = p3;
  planes[4] = p4;
  planes[5] = p5;
  planes[6] = p6;
}

struct Columns {
  std::span<const RowBits*const> level0, level1;
};

// One group of rows, a vector of them at a time.
template <class Lanes>
FRESHET_INLINED void add_up_group(const Columns& columns, std::size_t group, RowBits* sum, RowBits* bound) {
  for (std::size_t word = 0; word < 8; word += sizeof(Lanes) / 8) {
    Lanes whole[7], quarters[7], total[8], carry{};
    count(columns.level0, group, word, whole);
    count(columns.level1, group, word, quarters);
    for (int p = 0; p < 7; ++p) full_add(total[p], carry, whole[p], quarters[p], carry);
    total[7] = carry;
    for (int p = 0; p < 8; ++p) save(total[p], &sum[p].words[word]);
    // Twice I1 is its planes, one further up.
    save(total[0], &bound[0].words[word]);
    carry = Lanes{};
    for (int p = 1; p < 8; ++p) {
      full_add(total[p], carry, total[p], quarters[p - 1], carry);
      save(total[p], &bound[p].words[word]);
    }
    save(carry, &bound[8].words[word]);
  }
}

// Bits of `mask` whose number in nine planes is at least `score`; returns how many.
template <class Lanes>
FRESHET_INLINED int keep_in_group(const RowBits* planes, std::uint32_t score, std::uint64_t* mask) {
  for (std::size_t word = 0; word < 8; word += sizeof(Lanes) / 8) {
    Lanes allowed, equal, above{};
    load(allowed, mask + word);
    equal = allowed;
    for (int p = 8; p >= 0; --p) {
      Lanes plane;
      load(plane, &planes[p].words[word]);
      if (score >> p & 1) {
        equal &= plane;
      } else {
        above |= equal & plane;
        equal &= ~plane;
      }
    }
    equal |= above;
    save(equal, mask + word);
  }
  int kept = 0;
  for (int i = 0; i < 8; ++i) kept += std::popcount(mask[i]);
  return kept;
}

// The functions of one width.
struct Kernels {
  void (*add_up_group)(const Columns&, std::size_t, RowBits*, RowBits*);
  int (*keep_in_group)(const RowBits*, std::uint32_t, std::uint64_t*);
};
void add_up_128(const Columns& columns, std::size_t group, RowBits* sum, RowBits* bound) {
  add_up_group<Lanes128>(columns, group, sum, bound);
}
int keep_128(const RowBits* planes, std::uint32_t score, std::uint64_t* mask) {
  return keep_in_group<Lanes128>(planes, score, mask);
}
#if FRESHET_HAS_WIDE
__attribute__((target("arch=x86-64-v3"))) void add_up_256(const Columns& columns, std::size_t group,
                                                          RowBits* sum, RowBits* bound) {
  add_up_group<Lanes256>(columns, group, sum, bound);
}
__attribute__((target("arch=x86-64-v3"))) int keep_256(const RowBits* planes, std::uint32_t score,
                                                       std::uint64_t* mask) {
  return keep_in_group<Lanes256>(planes, score, mask);
}
__attribute__((target("arch=x86-64-v4"))) void add_up_512(const Columns& columns, std::size_t group,
                                                          RowBits* sum, RowBits* bound) {
  add_up_group<Lanes512>(columns, group, sum, bound);
}
__attribute__((target("arch=x86-64-v4"))) int keep_512(const RowBits* planes, std::uint32_t score,
                                                       std::uint64_t* mask) {
  return keep_in_group<Lanes512>(planes, score, mask);
}
#endif

Kernels choose_kernels() {
#if FRESHET_HAS_WIDE
  if (vector_bytes() == 64) return {add_up_512, keep_512};
  if (vector_bytes() == 32) return {add_up_256, keep_256};
#endif
  return {add_up_128, keep_128};
}
const Kernels kKernels = choose_kernels();

}  // namespace

void PyramidSums::add_up(std::span<const RowBits* const> level0, std::span<const RowBits* const> level1,
                         std::size_t groups) {
  assert(level0.size() < 128 && level1.size() < 128 && groups <= kGroups);
  for (std::size_t g = 0; g < groups; ++g)
    kKernels.add_up_group({level0, level1}, g, sum_[g].data(), bound_[g].data());
}

std::size_t PyramidSums::keep_reaching(std::uint32_t score, std::size_t groups, Mask& mask) const {
  assert(score < 512);
  std::size_t kept = 0;
  for (std::size_t g = 0; g < groups; ++g)
    kept += static_cast<std::size_t>(kKernels.keep_in_group(bound_[g].data(), score, mask.data() + g * 8));
  return kept;
}

}  // namespace freshet::query
