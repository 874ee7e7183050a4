// bench/choices/measured_cells.h — cells of the same clips under any setting, all from the same flow.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

#include "query/costs/pairwise.h"
#include "store/store.h"
#include "stored/patch_table.h"
#include "vision/settings.h"
#include "vision/temporal_spectrum.h"

namespace freshet::bench {

/// What all settings are computed from: a clip's first frames and the flow between them, by DIS.
struct Footage {
  std::vector<cv::Mat> luma, flow;
  double fps = 25;
};
Footage read_footage(const store::Snapshot& snapshot, store::ClipId id, std::uint32_t max_frames);

/// Cells of all clips under one setting.
struct Measured {
  vision::Settings settings;
  std::vector<vision::CellMap> motion;                // a clip
  std::vector<std::vector<vision::CellMap>> texture;  // a clip, a scale
  double cells_mb = 0, flow_mb = 0;                   // of all clips, as stored
};

/// Adds the next clip's cells, and what a store makes of them and of the flow.
/// folder   for a store that is removed again.
void measure(const Footage& footage, const store::ClipRecord& record, const std::filesystem::path& folder,
             Measured& to);

/// Features of the table's patches out of measured cells, clips in the table's order. Must not outlive them.
query::FeatureSource source_of(const Measured& measured, const store::Snapshot& snapshot,
                               const stored::PatchTable& table);

}  // namespace freshet::bench
