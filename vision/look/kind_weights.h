// vision/look/kind_weights.h — made by bench_kind FOOTAGE OUTLINES --weights FILE; not edited by hand.
#pragma once

#include <array>
#include <string_view>

namespace freshet::vision {

struct FigureWeights {
  std::string_view figure;
  double mean, deviation;            // over what was learned from
  std::array<double, 4> speaks_for;  // water, fire, smoke, clouds; per deviation
};

inline constexpr std::array<double, 4> kKindOffsets{1.921, -0.3171, -2.656, 1.052};
inline constexpr std::array<FigureWeights, 21> kKindWeights{{
    {"luma_mean", 0.4773, 0.186, {-0.4685, -0.04254, -0.5615, 1.073}},
    {"red_mean", -0.003156, 0.08939, {-0.524, 0.8374, 0.02577, -0.3391}},
    {"red_spread", 0.04192, 0.03739, {0.2427, 0.6978, -0.5564, -0.3841}},
    {"black_share", 0.07626, 0.1643, {-0.1595, 0.5761, -0.02595, -0.3906}},
    {"white_share", 0.07231, 0.1288, {0.07587, 0.5105, -0.03725, -0.5492}},
    {"warm_share", 0.06623, 0.1698, {-0.3815, 0.5872, -0.04056, -0.1651}},
    {"chroma_spread", 0.06075, 0.05617, {-0.4129, 0.534, -0.3634, 0.2423}},
    {"saturation_spread", 0.1183, 0.08649, {0.037, 0.6758, -0.876, 0.1632}},
    {"blue_share", 0.2997, 0.3643, {0.2061, -0.4552, -0.3748, 0.6238}},
    {"grey_share", 0.4672, 0.3588, {0.03741, -0.5786, 1.032, -0.4911}},
    {"detail", -3.61, 0.6223, {0.6422, 0.4115, -0.6886, -0.3651}},
    {"coarseness", 0.2135, 0.5103, {-1.361, 0.003976, 0.9162, 0.4403}},
    {"fineness", -1.691, 0.5401, {0.1711, 0.1659, -0.006074, -0.331}},
    {"coherence", 0.5861, 0.1393, {0.5957, -0.2645, -0.06265, -0.2685}},
    {"height", 0.03244, 0.1926, {0.9727, 0.1727, -0.6728, -0.4726}},
    {"aspect", 0.4552, 0.7304, {0.3087, -0.3379, -0.5153, 0.5444}},
    {"ring_luma", 0.102, 0.1573, {0.02208, 0.1023, -0.4805, 0.3561}},
    {"ring_blue", 0.008305, 0.0818, {0.3603, -0.3624, 0.3095, -0.3073}},
    {"red_on_luma", 0.07994, 0.2113, {0.9001, -0.2233, -0.7906, 0.1138}},
    {"blue_on_luma", -0.1471, 0.3172, {0.4298, 0.2305, 0.6863, -1.347}},
    {"saturation_on_luma", -0.2778, 0.6032, {-0.4272, 0.1799, 0.3634, -0.1161}},
}};

}  // namespace freshet::vision
