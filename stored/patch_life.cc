#include "stored/patch_life.h"

#include <cmath>
#include <cstddef>
#include <span>

#include "freshet/error.h"
#include "stored/clip_cells.h"
#include "stored/clip_schema.h"
#include "stored/patch_cells.h"

namespace freshet::stored {
namespace {

constexpr double kLeastPower = 1e-6;  // luma: where nothing was followed, cells count alike

/// What the covered cells say of one band of the source.
struct SourceBand {
  double log_life = 0, power = 0;
  bool known = false;
};

SourceBand between(const SourceBand& a, const SourceBand& b, double fraction) {
  if (fraction <= 0) return a;
  if (fraction >= 1) return b;
  SourceBand mixed{
      .log_life = 0, .power = (1 - fraction) * a.power + fraction * b.power, .known = a.known || b.known};
  if (a.known && b.known)
    mixed.log_life = (1 - fraction) * a.log_life + fraction * b.log_life;
  else
    mixed.log_life = a.known ? a.log_life : b.log_life;
  return mixed;
}

}  // namespace

std::optional<vision::CellMap> life_cells(const store::Snapshot& snapshot, store::ClipId clip) {
  if (!snapshot.has_column(clip, kLifeCells)) return std::nullopt;
  vision::CellMap cells =
      clip_cells(snapshot, clip, kLifeCells, metadata_of(snapshot, clip).cells.life, vision::kLifeChannels);
  for (std::size_t i = 0; i < cells.values.size(); ++i)
    if (cells.values[i] < 0 ||
        (i % vision::kLifeChannels < vision::kLifeBands && cells.values[i] > vision::kLongestLife_s))
      throw Error(ErrorKind::kDamaged, snapshot.clip(clip).name + ", column " + kLifeCells,
                  "a half-life or a contrast that cannot be", "Run freshet store verify");
  return cells;
}

PatchLife patch_life(const vision::CellMap& life, const vision::VariantFrame& frame, float scale,
                     cv::Point patch, int side) {
  std::array<SourceBand, vision::kLifeBands> source{};
  std::array<double, vision::kLifeBands> mass{};
  each_spot(life, frame, patch, side, [&](std::span<const float> values) {
    for (std::size_t b = 0; b < vision::kLifeBands; ++b) {
      const double contrast = values[vision::kLifeBands + b], power = contrast * contrast;
      source[b].power += power / (kSpots * kSpots);
      if (values[b] <= 0) continue;
      source[b].log_life += (power + kLeastPower) * std::log(values[b]);
      mass[b] += power + kLeastPower;
    }
  });
  for (std::size_t b = 0; b < vision::kLifeBands; ++b)
    if (mass[b] > 0) {
      source[b].known = true;
      source[b].log_life /= mass[b];
    }

  PatchLife found;
  for (int b = 0; b < vision::kLifeBands; ++b) {
    const auto [finer, fraction] = source_band(b, scale);
    const SourceBand band = between(source[finer], source[finer + 1], fraction);
    found.half_life_s[b] = band.known ? std::exp(band.log_life) : 0;
    found.power[b] = band.power;
  }
  return found;
}

}  // namespace freshet::stored
