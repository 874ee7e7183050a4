// synth/scene/kinds/water.h — a plane of waves (Chuang et al. 2005, Sec. 3.3).
#pragma once

#include <algorithm>
#include <optional>

#include "synth/scene/kinds/kind.h"
#include "synth/scene/kinds/line.h"

namespace freshet::synth {
class Section;
}

namespace freshet::synth::scene {

/// What of the water's surface moves the picture.
enum class WaterMapping {
  kDisplacement,  // as printed (Eq. 10): a point of the plane is lifted by the wave's height
  kNormals,       // what is mirrored moves as the surface tilts
};

struct WaterMotion {
  static constexpr const char* kName = "water";
  static constexpr Pixels kPixels = Pixels::kCut;

  std::optional<Line> horizon{};     // set once marks are read
  std::optional<double> focal_px{};  // nothing: 1.2 times the picture's longer side
  double camera_height_m = 0.5;      // above the water
  int tile = 256;                    // samples along a tile's side, N; a power of 2
  std::optional<double> tile_m{};    // its side at roughness 1; nothing: 25 L, L = speed^2 / 9.81 m/s^2
  double roughness = 25;             // beta: waves are so many times shorter than the sea's
  /// a; 1: as high as those of a fully developed sea of this roughness. Nothing: .3 for displacement, .04 for normals,
  /// with which stills of lakes move as their clips (docs/scene.md).
  std::optional<double> amplitude{};
  double against = 0.3;                   // amplitude of waves against the wind, fractions; 1 as printed
  std::optional<WaterMapping> mapping{};  // nothing: by the angle at which the water is seen (mapping_seen)
  double calm = 0;  // how far the still's own ripples are smoothed out, of the distance below the horizon
  bool mirrors = false;     // what moves above the horizon, but boats, moves mirrored in it too
  bool edge_moves = false;  // true: the matte moves with the water (the paper); else only what lies in it
  double focal_or_usual(cv::Size picture) const {
    return focal_px.value_or(1.2 * std::max(picture.width, picture.height));
  }
  double amplitude_or_usual() const {
    return amplitude.value_or(mapping == WaterMapping::kNormals ? 0.04 : 0.3);
  }
  double gust_darkening = 0.15;  // of the light, under a gust of one standard deviation; with gustiness alone

  /// What its keys ask of each other.
  void check(const Section& section) const;
};

template <>
const std::vector<Key<WaterMotion>>& keys_of<WaterMotion>();

}  // namespace freshet::synth::scene
