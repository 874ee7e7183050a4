// synth/scene/motion/water_surface.h — how waves move what a picture shows of the water (Chuang et al. 2005, Sec. 3.3).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/scene/cycle.h"
#include "synth/scene/motion/motion.h"
#include "synth/scene/scene.h"
#include "synth/scene/water/camera.h"
#include "synth/scene/water/height_field.h"
#include "synth/scene/water/reduced_tile.h"
#include "synth/scene/wind/gusts.h"

namespace freshet::synth::scene {

/// Which mapping suits water in these rows of the picture, when nobody says: normals where all of it is seen at grazing
/// angles. There it mirrors (at 17 degrees a sixth of the light, at 5 more than half: Fresnel), and has little of its
/// own to be lifted; from nearer, it is the waves themselves that one sees.
/// water   with horizon and focal length.
WaterMapping mapping_seen(const WaterMotion& water, const cv::Rect& region, cv::Size picture);

/// Displacement as printed (Eq. 10): what lies on the plane is lifted by the height above it. The inverse is the
/// negative of the displacement at the pixel itself, as in the paper: it is continuous; the true inverse folds where
/// waves are steep, and would show water from behind a crest twice. The negative folds too where rows that follow each
/// other are displaced by amounts that differ by more than a pixel, and looks torn: there the
/// shortest waves are left out.
///
/// Normals: a mirror image moves by what the reflected ray turns, twice the surface's slope: 2 f
/// slope_away up or down, and to the side 2 f slope_right times the sine of the angle at which the plane is
/// seen. Slopes of what is smaller than a pixel do not move it, they would blur it.
///
/// Waves shorter than an 80th of the picture's longer side are left out whatever its size in pixels, and those shorter
/// than 4 px. On real lakes mirror images do not follow such ripples: with all that 640 px can show, a lake's luma
/// varied by 10 dB more than its clip's does, and far too fast; at 320 px it did as the clip.
class WaterSurface : public Motion {
 public:
  /// region    px of the picture in which rows will be asked.
  /// boats     px, where displacement() will be; empty: nowhere.
  /// water     with horizon and focal length.
  WaterSurface(const WaterMotion& water, const Gusts& gusts, const Cycle& cycle, std::uint64_t seed,
               const cv::Rect& region, cv::Size picture, const cv::Rect& boats = {});

  void go_to(int frame) override;
  float reach() const override { return reach_; }
  void row(int copy, int x, int y, int n, float* dx, float* dy) const override;
  bool light(int x, int y, int n, float* factor) const override;

  /// d of Eq. 10, px, of the point at the middle of pixel (x, y), which may lie between pixels: for boats. It is the
  /// surface's own, also where the mapping moves mirror images, which go many times as far.
  cv::Point2d displacement(double x, double y) const;
  /// m, of the surface above its mean there.
  double height(double x, double y) const;
  const WaterCamera& camera() const { return camera_; }

 private:
  static constexpr int kUnit = 16;  // px between the columns at which gusts are asked

  struct Line {
    double below = 0;
    WaterCamera::Row camera{};
    float coarse =
        1;  // waves are left out as if a pixel covered that many times what it does (leave_out_folds)
    float held = 1;    // of the height of the waves that are left, 0..1
    bool calm = true;  // at or above the horizon, or too far for any wave
  };
  /// The planes' rows at one line of the rolled frame.
  float* profile(std::size_t line, int plane) {
    return profiles_.data() +
           (line * static_cast<std::size_t>(field_.planes()) + static_cast<std::size_t>(plane)) *
               static_cast<std::size_t>(field_.samples());
  }
  const float* profile(std::size_t line, int plane) const {
    return const_cast<WaterSurface*>(this)->profile(line, plane);
  }
  /// A plane pair's value between lines and samples: heights h, or slopes to the right and away.
  struct Surface {
    float first = 0, second = 0;
  };
  Surface at(double below, double along) const;
  /// So high as the camera's place allows.
  double held_height(double m) const;
  cv::Point2d rolled_displacement(double below, double along, float gain) const;
  /// The planes' rows of the frame at one line; scratch of 2 N floats. Returns the greatest sum that they may have.
  float sample_line(std::size_t line, float* scratch);
  void sample_lines();
  /// px, that a row may be displaced by what is at most `most` high, or steep.
  double reach_of(const WaterCamera::Row& row, double most) const;
  /// px down, for 1 of a plane's value at this line.
  double down_of(const Line& line, int plane) const;
  /// px^2: mean square of what displacements differ by between this line and the next.
  double step_power(std::size_t line) const;
  /// The same at every line with these waves left out, averaged over moments of the cycle and lines around.
  std::vector<double> step_powers(float coarse);
  /// What of the waves every line shows.
  struct Shown {
    std::vector<float> coarse, held;  // Line's
  };
  /// Bounds that: where waves are too steep for the picture's rows, short ones are left out, all the time alike; where
  /// the wind changes, as the weather asks that is at `seconds_`.
  Shown without_folds();
  void leave_out_folds();
  /// The lines' coarse and held between two of shown_, 0..1.
  void show(std::size_t first, float part);
  /// Which levels of the tiles a line asks for; of none any.
  void need_line(const Line& line, float coarse);
  void need_nothing();
  float gain_at(double x) const;

  WaterMotion water_;
  const Gusts* gusts_;
  Cycle cycle_;
  WaterCamera camera_;
  double focal_;
  cv::Size picture_;
  HeightField field_;
  std::vector<ReducedTile> reduced_;
  std::vector<double> knots_;  // s: moments of the weather at which shown_ is known; one where the wind stays
  std::vector<Shown> shown_;
  double seconds_ = 0;  // of the weather, in without_folds
  int first_line_ = 0;
  std::vector<Line> lines_;
  std::vector<float> profiles_;
  std::vector<float> gain_, shade_;  // at columns 0, kUnit, ...
  std::vector<float> highest_;       // of a line's profiles, in the frame
  float reach_ = 0;
  std::unique_ptr<WaterSurface> heights_;  // of the same waves, where boats lie; when the rows are of slopes
};

}  // namespace freshet::synth::scene
