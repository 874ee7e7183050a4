// query/costs/steadiness.h — whether a patch keeps its direction, or goes to and fro.
#pragma once

#include <span>
#include <vector>

#include "store/store.h"
#include "stored/patch_table.h"
#include "vision/settings.h"

namespace freshet::query {

/// Of each row, 0..1: its mean motion's square, over that and the power of the two lowest bands (0.8 to 1.6 Hz)
/// along the mean; 1 flows for ever, 0 surges. Means over the patch's cells. What a carried picture shows of a
/// patch that surges is a river that runs down, up and down.
///
/// rows     any, kNoRow too (0); those that come again are measured once.
/// Throws   as motion_cells.
/// Cost     1 us per distinct row; one clip's cells a thread.
std::vector<float> steadiness(const store::Snapshot& snapshot, const vision::Settings& settings,
                              const stored::PatchTable& table, std::span<const stored::Row> rows);

}  // namespace freshet::query
