// vision/settings.h — everything that a store's patches depend on: the same for all of its clips.
#pragma once

#include <string>
#include <vector>

#include "vision/codebook.h"
#include "vision/flow.h"
#include "vision/patch_grid.h"
#include "vision/temporal_spectrum.h"
#include "vision/variant.h"

namespace freshet::vision {

/// Chosen when a store is made, kept in it as JSON, and read back by whatever searches it.
struct Settings {
  std::vector<float> scales{1.0f, 0.75f, 0.5f};
  std::vector<float> rotations_deg{-22.5f, 0.0f, 22.5f};
  bool flips = true;
  PatchGrid grid;
  double min_coverage = 0.5;      // fraction of a patch's pixels that must move
  double min_motion_px = 0.2;     // mean |flow| that counts as moving, px per frame at 25 frames per second
  double min_change = 1.5 / 255;  // standard deviation over time that counts as moving, luma in 0..1
  FlowOptions flow;
  int flow_step = 2;  // flow is kept at 1 / flow_step of the frame's resolution
  SpectrumOptions spectrum;
  int texture_cell = 4;  // px of the variant's scale
  CodebookOptions codebook;

  std::vector<Variant> variants() const { return make_variants(scales, rotations_deg, flips); }
};

std::string to_json(const Settings& settings);
/// Throws Error{kDamaged} when a field is missing or out of range, and when there is one that we do not know:
/// it could change what a patch means. Also refused: a patch that is not a multiple of 8 px (the descriptor
/// grid) or of spectrum.cell, a spectrum.cell that is not a multiple of flow_step, more than 256 variants.
Settings settings_from_json(const std::string& json);

}  // namespace freshet::vision
