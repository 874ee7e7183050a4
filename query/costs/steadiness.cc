#include "query/costs/steadiness.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <oneapi/tbb/parallel_for.h>

#include "stored/clip_cells.h"

namespace freshet::query {
namespace {

constexpr int kLowBands = 2;
constexpr double kLeast = 1e-9;  // (px/s)^2: what does not move at all surges

double of_patch(const vision::CellMap& cells, const vision::VariantFrame& frame, int x, int y, int patch) {
  const int across = std::max(1, static_cast<int>(std::lround(patch / cells.cell)));
  const int bands = std::min(kLowBands, vision::bands_of(cells.channels));
  double u = 0, v = 0, uu = 0, vv = 0, uv = 0;
  for (int row = 0; row < across; ++row)
    for (int column = 0; column < across; ++column) {
      const cv::Vec2d at = frame.source_from_variant * cv::Vec3d(x + (column + 0.5) * cells.cell - 0.5,
                                                                 y + (row + 0.5) * cells.cell - 0.5, 1);
      const std::span<const float> cell = stored::covering_cell(cells, at);
      u += cell[0];
      v += cell[1];
      for (int band = 0; band < bands; ++band) {
        const vision::BandPower power = vision::band_power(cell.data(), band);
        uu += power.u;
        vv += power.v;
        uv += power.cross;
      }
    }
  const double count = across * across, square = (u * u + v * v) / (count * count);
  if (square < kLeast) return 0;
  const double along = (u * u * uu + 2 * u * v * uv + v * v * vv) / (u * u + v * v) / count;
  return square / (square + std::max(along, 0.0));
}

}  // namespace

std::vector<float> steadiness(const store::Snapshot& snapshot, const vision::Settings& settings,
                              const stored::PatchTable& table, std::span<const stored::Row> rows) {
  std::vector<stored::Row> distinct(rows.begin(), rows.end());
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  while (!distinct.empty() && distinct.back() == stored::kNoRow) distinct.pop_back();
  std::vector<float> values(distinct.size());

  std::vector<std::size_t> first;  // of each clip, whose rows lie together
  for (std::size_t i = 0; i < distinct.size(); ++i)
    if (i == 0 || table.clip[distinct[i]] != table.clip[distinct[i - 1]]) first.push_back(i);
  first.push_back(distinct.size());
  const std::vector<vision::Variant> variants = settings.variants();
  oneapi::tbb::parallel_for(std::size_t{0}, first.size() - 1, [&](std::size_t c) {
    const store::ClipId clip = table.clips[table.clip[distinct[first[c]]]];
    const store::ClipRecord& record = snapshot.clip(clip);
    const cv::Size frame(static_cast<int>(record.width), static_cast<int>(record.height));
    const vision::CellMap cells = stored::motion_cells(snapshot, settings, clip);
    std::vector<std::optional<vision::VariantFrame>> frames(variants.size());
    for (std::size_t i = first[c]; i < first[c + 1]; ++i) {
      const stored::Row row = distinct[i];
      auto& turned = frames[table.variant[row]];
      if (!turned) turned = vision::variant_frame(frame, variants[table.variant[row]]);
      values[i] =
          static_cast<float>(of_patch(cells, *turned, table.x[row], table.y[row], settings.grid.patch));
    }
  });

  std::vector<float> answer(rows.size(), 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto found = std::lower_bound(distinct.begin(), distinct.end(), rows[i]);
    if (found != distinct.end() && *found == rows[i]) answer[i] = values[found - distinct.begin()];
  }
  return answer;
}

}  // namespace freshet::query
