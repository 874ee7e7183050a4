#include "stored/clip_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "freshet/error.h"
#include "platform/vectors.h"
#include "stored/clip_schema.h"
#include "vision/textureness.h"

namespace freshet::stored {
namespace {

[[noreturn]] void fail(const store::ClipRecord& record, const std::string& column, const std::string& fault) {
  throw Error(ErrorKind::kDamaged, record.name + ", column " + column, fault, "Run freshet store verify");
}

// An exponent of all ones: infinite, or no number. In one pass without a branch, which takes wide vectors.
FRESHET_WIDE bool all_finite(const float* values, std::size_t count) {
  constexpr std::uint32_t kExponent = 0x7f800000;
  std::uint32_t bad = 0;
  for (std::size_t i = 0; i < count; ++i)
    bad |= (std::bit_cast<std::uint32_t>(values[i]) & kExponent) == kExponent ? 1u : 0u;
  return bad == 0;
}

}  // namespace

vision::CellMap clip_cells(const store::Snapshot& snapshot, store::ClipId clip, const std::string& column,
                           const std::optional<CellShape>& shape, int channels) {
  const store::ClipRecord& record = snapshot.clip(clip);
  if (!shape) fail(record, column, "the clip's metadata do not give its shape");
  if (shape->channels != channels) fail(record, column, "the shape in the clip's metadata is impossible");
  vision::CellMap cells{.rows = shape->rows,
                        .columns = shape->columns,
                        .channels = shape->channels,
                        .cell = shape->cell,
                        .values = snapshot.records<float>(clip, column, static_cast<std::size_t>(channels))};
  const std::size_t expected = static_cast<std::size_t>(cells.rows) *
                               static_cast<std::size_t>(cells.columns) * static_cast<std::size_t>(channels);
  if (cells.values.size() != expected) {
    fail(
        record, column,
        std::to_string(cells.values.size()) + " values where " + std::to_string(expected) + " were expected");
  }
  if (!all_finite(cells.values.data(), cells.values.size()))
    fail(record, column, "a value that is no number");
  return cells;
}

vision::CellMap motion_cells(const store::Snapshot& snapshot, const vision::Settings& settings,
                             store::ClipId clip) {
  return clip_cells(snapshot, clip, kMotionCells, metadata_of(snapshot, clip).cells.motion,
                    vision::motion_channels(settings.spectrum));
}

vision::CellMap texture_cells(const store::Snapshot& snapshot, const vision::Settings& settings,
                              store::ClipId clip, std::size_t scale) {
  if (scale >= settings.scales.size()) {
    throw Error(ErrorKind::kUsage, "scale " + std::to_string(scale), "the store has no such scale");
  }
  const std::vector<CellShape> shapes = metadata_of(snapshot, clip).cells.texture;
  return clip_cells(snapshot, clip, texture_cells_name(scale),
                    scale < shapes.size() ? std::optional(shapes[scale]) : std::nullopt,
                    vision::kTextureLevels);
}

std::size_t scale_index(const vision::Settings& settings, const vision::Variant& variant) {
  const auto found = std::find(settings.scales.begin(), settings.scales.end(), variant.scale);
  if (found == settings.scales.end()) {
    throw Error(ErrorKind::kDamaged, "the store's settings", "a variant of a scale that is not listed");
  }
  return static_cast<std::size_t>(found - settings.scales.begin());
}

}  // namespace freshet::stored
