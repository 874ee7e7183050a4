#include "synth/scene/kinds/water.h"

#include <bit>

#include <fmt/format.h>

#include "synth/scene/kinds/kind_keys.h"

namespace freshet::synth::scene {
namespace {

void read_horizon(Section& section, WaterMotion& water) { water.horizon = line_of(section, "horizon"); }
void take_mapping(WaterMotion& water, std::size_t word) {
  water.mapping = word == 1 ? WaterMapping::kNormals : WaterMapping::kDisplacement;
}
void take_edge(WaterMotion& water, std::size_t word) { water.edge_moves = word == 1; }

}  // namespace

template <>
const std::vector<Key<WaterMotion>>& keys_of<WaterMotion>() {
  static const std::vector<Key<WaterMotion>> keys{
      {"horizon", read_horizon, {}, "", "[x, y, x, y] on the horizon", "the marks'"},
      {"focal",
       &WaterMotion::focal_px,
       {1, kFarPx},
       "px",
       "focal length",
       "1.2 times the picture's longer side"},
      {"camera_height",
       &WaterMotion::camera_height_m,
       {0.01, 1e4},
       "m",
       "height of the camera above the water"},
      {"tile", &WaterMotion::tile, {32, 1024}, "", "samples along a side of the waves' tile, a power of 2"},
      {"tile_size",
       &WaterMotion::tile_m,
       {0.01, 1e6},
       "m",
       "side of the tile at roughness 1",
       "25 speed^2 / g"},
      {"roughness", &WaterMotion::roughness, {0.01, 1e5}, "", "waves are so many times shorter than a sea's"},
      {"amplitude",
       &WaterMotion::amplitude,
       {0, 1000},
       "",
       "1: as high as a sea's waves of this roughness",
       ".3; with normals .04",
       Range{0, 1}},
      {"against",
       &WaterMotion::against,
       {0, 1},
       "",
       "amplitude of waves against the wind, a share of the others'; 1 as in the paper"},
      {"mapping",
       Words<WaterMotion>{{"displacement", "normals"}, take_mapping},
       {},
       "",
       "what lies on the water is lifted, or what is mirrored moves as the surface tilts",
       "normals where the water is seen nowhere more steeply than at 17 degrees, as most lakes are"},
      {"calm",
       &WaterMotion::calm,
       {0, 0.2},
       "",
       "the still's own ripples are smoothed out before waves move it, along its columns, by so much of the "
       "distance below the horizon; 0: they stay in it and move like all else, .03 to .08 take a lake's out"},
      {"mirrors",
       &WaterMotion::mirrors,
       {},
       "",
       "true: what moves above the horizon, but boats, moves mirrored in it too, as much as the still's "
       "colours say; "
       "with edge = \"held\""},
      {"edge",
       Words<WaterMotion>{{"held", "moving"}, take_edge},
       {},
       "",
       "whether the outline moves with the water, as in the paper"},
      {"gust_darkening",
       &WaterMotion::gust_darkening,
       {0, 1},
       "",
       "share of the light that a gust of one standard deviation takes; with gustiness alone"}};
  return keys;
}

void WaterMotion::check(const Section& section) const {
  if (!std::has_single_bit(static_cast<unsigned>(tile)))
    section.refuse("tile", fmt::format("{} is no power of 2", tile), "Give 64, 128, 256 or 512");
  if (mirrors && edge_moves)
    section.refuse("mirrors", "what is mirrored lies in an outline that is held, and edge is \"moving\"",
                   "Take one of the two out");
}

}  // namespace freshet::synth::scene
