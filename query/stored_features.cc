#include "query/stored_features.h"

#include <set>

#include "query/clip_cells.h"
#include "vision/patch_features.h"

namespace freshet::query {

std::size_t StoredFeatures::ClipCells::bytes() const {
  std::size_t values = motion.values.size();
  for (const auto& [scale, cells] : texture) values += cells.values.size();
  return values * sizeof(float);
}

StoredFeatures::StoredFeatures(const store::Snapshot& snapshot, const vision::Settings& settings,
                               const PatchTable& table, std::size_t cache_bytes)
    : snapshot_(snapshot),
      settings_(settings),
      table_(table),
      cache_bytes_(cache_bytes),
      variants_(settings.variants()) {}

void StoredFeatures::prepare(std::span<const Row> rows) {
  std::set<std::pair<std::uint32_t, std::size_t>> needed;  // clip, variant
  for (const Row row : rows) needed.emplace(table_.clip[row], table_.variant[row]);
  std::size_t held = 0;
  for (const auto& [clip, cells] : clips_) held += cells.bytes();
  if (held > cache_bytes_) {
    std::erase_if(clips_, [&](const auto& entry) {
      const auto next = needed.lower_bound({entry.first, 0});
      return next == needed.end() || next->first != entry.first;
    });
  }
  for (const auto& [clip, variant] : needed) {
    const store::ClipId id = table_.clips[clip];
    ClipCells& cells = clips_[clip];
    if (cells.motion.values.empty()) cells.motion = motion_cells(snapshot_, settings_, id);
    const std::size_t scale = scale_index(settings_, variants_[variant]);
    if (!cells.texture.contains(scale)) {
      cells.texture.emplace(scale, texture_cells(snapshot_, settings_, id, scale));
    }
    if (!cells.frames.contains(variant)) {
      const store::ClipRecord& record = snapshot_.clip(id);
      const cv::Size source(static_cast<int>(record.width), static_cast<int>(record.height));
      cells.frames.emplace(variant, vision::variant_frame(source, variants_[variant]));
    }
  }
}

void StoredFeatures::read(Row row, std::span<float> features) const {
  const ClipCells& cells = clips_.at(table_.clip[row]);
  const std::size_t variant = table_.variant[row];
  vision::patch_features(cells.motion, cells.texture.at(scale_index(settings_, variants_[variant])),
                         cells.frames.at(variant), table_.x[row], table_.y[row], settings_.grid.patch,
                         settings_.spectrum, features);
}

FeatureSource StoredFeatures::source() & {
  return {[this](std::span<const Row> rows) { prepare(rows); },
          [this](Row row, std::span<float> features) { read(row, features); }};
}

}  // namespace freshet::query
