// synth/scene/motion/floating_sheet.h — a boat that stands on the water in three dimensions, as a sheet.
#pragma once

#include <span>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/motion/motion.h"
#include "synth/scene/motion/water_surface.h"
#include "synth/scene/scene.h"
#include "synth/scene/water/camera.h"

namespace freshet::synth::scene {

/// Where a boat floats: vectors from the camera, m right, away from the viewer and up.
struct Waterplane {
  cv::Vec3d middle;         // of the hull line
  cv::Vec3d along, across;  // unit and level: along the hull to the right, and to the left of that, away
  double length_m, beam_m;
};
/// A line along the waterline, laid on the water. How far away its ends are follows from their rows, but a few rows
/// more are many metres on far water, and a boat that lists is no nearer on one side: the plane is turned by 45 degrees
/// at most. A camera that sees the middle from 45 degrees aside may see such a plane along its edge (sees_side).
/// The beam is a third of the length, as small boats have it.
/// hull   its middle below the horizon; px of the picture, of some length.
Waterplane waterplane_of(const Line& hull, const WaterCamera& camera);

/// Whether the camera sees the plane that stands on it, and not its edge: from half a degree beside that.
bool sees_side(const Waterplane& plane);

/// How a boat lies at a moment.
struct Attitude {
  double heave_m = 0;  // up
  double pitch = 0;    // rad: the end that `along` goes to is up
  double roll = 0;     // rad: the side that `across` goes to is up
  double yaw = 0;      // rad: that end goes to that side
};

/// A lattice over the waterplane, kAcross points from side to side at each of some stations along.
class HullStations {
 public:
  static constexpr int kAcross = 5;
  explicit HullStations(int count);

  std::size_t count() const { return along_.size(); }
  /// A point, in half lengths along and half beams across.
  cv::Point2d at(std::size_t station, int point) const;
  /// How a boat lies on waves of these heights, m, a station after the other.
  ///
  /// The least-squares surface h = heave + pitch u + roll v + twist u v under a waterplane that is pointed at both ends
  /// (a parabola's breadth): waves shorter than the hull are averaged away, as the inertia of a boat averages them.
  /// Water goes round and round as a wave passes, to the side by slope / k: at bow and stern by different ways,
  /// which yaws what floats by twist / k. k is that of waves of two hulls' length, which yaw it most.
  Attitude on(std::span<const double> heights, double length_m, double beam_m) const;

 private:
  double breadth(std::size_t station) const { return 1 - along_[station] * along_[station]; }

  std::vector<double> along_;  // -1..1
};

/// How broadly the camera sees a plane that stands on the water along the hull and moves with it, a share of how
/// broadly it sees it in the still: that of the boat or of its reflection, whichever is less. 0 or less: its edge, or
/// its back.
double breadth_seen(const Waterplane& plane, const Attitude& attitude);
inline constexpr double kLeastBreadth = 0.25;  // a plane seen along its edge has no way back
/// The same attitude, its turns lessened alike until breadth_seen is kLeastBreadth.
Attitude held_broad(const Waterplane& plane, const Attitude& attitude);

/// The way back of a plane that stands on the water along the hull and moves with it: homogeneous px of the picture, at
/// the moment and in the still. mirrored   of its reflection in level water. attitude   with a breadth_seen above 0.
cv::Matx33d still_from_moved(const WaterCamera& camera, const Waterplane& plane, const Attitude& attitude,
                             bool mirrored);

/// The layer as such a sheet: a homography, whose inverse is exact. A reflection is the mirror image of the boat
/// that moved, and is moved by the water's waves besides.
class FloatingSheet : public Motion {
 public:
  /// boat    with its hull line, whose middle lies below the horizon. water   gone to the same frame before this is.
  FloatingSheet(const BoatMotion& boat, const WaterSurface& water, bool reflection, const cv::Rect& region);

  void go_to(int frame) override;
  float reach() const override;
  void row(int copy, int x, int y, int n, float* dx, float* dy) const override;

  const Attitude& attitude() const { return attitude_; }

 private:
  BoatMotion boat_;
  const WaterSurface* water_;
  bool reflection_;
  cv::Rect region_;
  Waterplane plane_;
  HullStations stations_;
  std::vector<cv::Point2d> points_;  // of the lattice, px
  std::vector<double> heights_;
  Attitude attitude_;
  cv::Matx33d back_ = cv::Matx33d::eye();
};

/// px, that heights are asked in; no further than 1e6 where a side of the boat lies at the camera or behind it.
cv::Rect waterplane_box(const Waterplane& plane, const WaterCamera& camera);

}  // namespace freshet::synth::scene
