// synth/simulate/clips/gas.h — what smoke, fire and ink share: a flow, what it carries, the picture in it.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synth/simulate/clips/carried_texture.h"
#include "synth/simulate/scene/scene_options.h"
#include "synth/simulate/solver/noise.h"
#include "synth/simulate/solver/stable_fluids.h"

namespace freshet::synth::simulate {

/// The flow is solved on cells of several pixels, what it carries on pixels; both reach beyond the picture,
/// so that no rim shows.
struct Domain {
  /// Margins in fractions of the picture.
  Domain(const SceneOptions& options, float margin_x, float margin_top, float margin_bottom);

  cv::Size picture;
  int step;           // px per cell
  int width, height;  // cells
  int left, top;      // px of the domain left of and above the picture
  float scale;        // picture px per px of a 640 x 360 design, with the zoom

  int fine_width() const { return width * step; }
  int fine_height() const { return height * step; }
  float cell_from_fine(float px) const { return (px + 0.5f) / static_cast<float>(step) - 0.5f; }
};

class Gas {
 public:
  Gas(const Domain& domain, float zoom, const StableFluidsOptions& options, int fields, int texture_life,
      const GridOf<std::uint8_t>& solid = {});

  const Domain domain;
  const float zoom;  // of the eddies that stir() adds: cells do not grow with it
  StableFluids flow;
  CarriedTexture texture;
  std::vector<Grid> fields;  // px of the domain
  VectorGrid force;          // cells, cells per frame per frame

  /// One frame: the flow under `force`, then every field along it.
  /// kSoft reads fields linearly, so that edges melt away as those of thin smoke do; kSharp keeps filaments.
  enum class Edges { kSoft, kSharp };
  void advance(Edges edges);

  /// Adds the curl of a changing noise to `force` where amount (a cell grid) is above 0: eddies that the
  /// solver's grid and its smoothing lose.
  void stir(const Noise& noise, float time, float size_cells, float strength, const Grid& amount);

  /// Drag that grows with the square of the speed: nothing goes much faster than `terminal` (cells per frame)
  /// under a push of `push`. Without it, wide plumes in two dimensions run away: nothing drags at them from
  /// the front and the back.
  void hold_back(float terminal, float push);

  /// Mean of a field over each cell.
  void reduce(const Grid& field, Grid& cells) const;

  /// Flow at a picture pixel, px per frame.
  Vec2 motion_at(int x, int y) const;

 private:
  Grid scratch_, stream_;
};

}  // namespace freshet::synth::simulate
