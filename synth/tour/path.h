// synth/tour/path.h — where the camera is at each moment of a tour.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "synth/tour/camera.h"

namespace freshet::synth::tour {

struct PathKey {
  double time_s = 0;
  CameraPlace place;
};

/// Goes through its keys, each number by itself: monotone cubics, so that between two keys nothing leaves their range.
/// Source   Fritsch, Butland 1984, A method for constructing local monotone piecewise cubic interpolants.
class Path {
 public:
  /// keys    at least one, times growing; views all above 0, or all 0.
  /// eased   it starts from rest and comes to rest.
  Path(std::vector<PathKey> keys, bool eased);
  /// Before the first key and after the last it rests there.
  CameraPlace at(double time_s) const;
  const std::vector<PathKey>& keys() const { return keys_; }
  double seconds() const { return keys_.back().time_s; }

 private:
  static constexpr int kNumbers = 6;
  std::vector<PathKey> keys_;
  std::vector<std::array<double, kNumbers>> values_, slopes_;
};

/// Moves that need no keys.
enum class Move { kIn, kPan, kTruck, kRise, kOrbit };
inline const std::vector<std::string>& move_names() {
  static const std::vector<std::string> names{"in", "pan", "truck", "rise", "orbit"};
  return names;
}

/// How far a scene lets a camera go.
struct Reach {
  double ahead = 1;  // to the nearest thing or floor that the picture shows
  double aside = 1;  // half of what the picture shows to the side there
  double pivot = 2;  // depth that an orbit turns about
};
/// in: ahead. pan: turns from left to right. truck: from left to right. rise: upwards. orbit: around what lies at the
/// pivot and back where it began, without rest, so that a film that loops still does. amount   1: as far as looks well.
Path made_path(Move move, double amount, double seconds, const Reach& reach, bool eased);

}  // namespace freshet::synth::tour
