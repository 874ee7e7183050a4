#include "query/costs/stored_features.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <optional>

#include "stored/clip_cells.h"
#include "vision/patch_features.h"

namespace freshet::query {

StoredFeatures::StoredFeatures(const store::Snapshot& snapshot, const vision::Settings& settings,
                               const stored::PatchTable& table)
    : snapshot_(snapshot),
      settings_(settings),
      table_(table),
      shape_(feature_shape(settings)),
      variants_(settings.variants()) {}

void StoredFeatures::squares(stored::Row row, std::span<Square> out) const {
  const int side = shape_.square() * settings_.spectrum.cell, count = shape_.squares();
  std::size_t at = 0;
  for (int y = 0; y < count; ++y)
    for (int x = 0; x < count; ++x)
      out[at++] = {table_.clip[row], table_.variant[row],
                   static_cast<std::uint16_t>(table_.y[row] + y * side),
                   static_cast<std::uint16_t>(table_.x[row] + x * side)};
}

void StoredFeatures::read(std::span<const Square> squares, const SquareSink& sink) const {
  std::vector<std::size_t> first;  // of each clip
  for (std::size_t i = 0; i < squares.size(); ++i)
    if (i == 0 || squares[i].clip != squares[i - 1].clip) first.push_back(i);
  first.push_back(squares.size());
  oneapi::tbb::parallel_for(std::size_t{0}, first.size() - 1, [&](std::size_t i) {
    read_clip(squares.subspan(first[i], first[i + 1] - first[i]), first[i], sink);
  });
}

void StoredFeatures::read_clip(std::span<const Square> squares, std::size_t first,
                               const SquareSink& sink) const {
  const store::ClipId id = table_.clips[squares[0].clip];
  const store::ClipRecord& record = snapshot_.clip(id);
  const cv::Size frame(static_cast<int>(record.width), static_cast<int>(record.height));
  const vision::CellMap motion = stored::motion_cells(snapshot_, settings_, id);
  std::map<std::size_t, vision::CellMap> texture;  // by scale
  struct VariantView {
    vision::VariantFrame frame;
    const vision::CellMap* texture;
  };
  std::vector<std::optional<VariantView>> views(variants_.size());
  for (const Square& square : squares) {
    const vision::Variant& variant = variants_[square.variant];
    if (views[square.variant]) continue;
    const std::size_t scale = stored::scale_index(settings_, variant);
    auto cells = texture.find(scale);
    if (cells == texture.end())
      cells = texture.emplace(scale, stored::texture_cells(snapshot_, settings_, id, scale)).first;
    views[square.variant] = VariantView{vision::variant_frame(frame, variant), &cells->second};
  }
  // Isolated: a thread that waits here takes no other clip, whose cells would come on top of these.
  const int side = shape_.square() * settings_.spectrum.cell;
  oneapi::tbb::this_task_arena::isolate([&] {
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, squares.size(), 64),
                              [&](const auto& range) {
                                std::vector<float> features(shape_.square_values());
                                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                                  const Square& square = squares[i];
                                  const VariantView& view = *views[square.variant];
                                  vision::patch_features(motion, *view.texture, view.frame, square.x,
                                                         square.y, side, settings_.spectrum, features);
                                  sink(first + i, features);
                                }
                              });
  });
}

FeatureSource StoredFeatures::source() const& {
  return {[this](stored::Row row, std::span<Square> out) { squares(row, out); },
          [this](std::span<const Square> all, const SquareSink& sink) { read(all, sink); }};
}

}  // namespace freshet::query
