#include "stored/clip_columns.h"

#include <span>
#include <string>

#include "freshet/error.h"
#include "stored/clip_schema.h"

namespace freshet::stored {
namespace {

store::PlaneView view_of(const cv::Mat& plane) {
  return {reinterpret_cast<const std::byte*>(plane.data), static_cast<std::ptrdiff_t>(plane.step)};
}

void write_cells(store::ClipWriter& writer, const std::string& name, const vision::CellMap& cells) {
  if (cells.channels == 0) return;
  writer.column_bytes(name, std::as_bytes(std::span(cells.values)),
                      static_cast<std::uint32_t>(static_cast<std::size_t>(cells.channels) * sizeof(float)));
}

template <class T>
void write_unless_empty(store::ClipWriter& writer, const Column<T>& column, const std::vector<T>& rows) {
  if (!rows.empty()) column.write(writer, rows);
}

}  // namespace

vision::OwnWordMaps WordColumn::read(const store::Snapshot& snapshot, store::ClipId clip,
                                     int word_bytes) const {
  const std::size_t row_bytes = vision::word_map_bytes(word_bytes);
  if (const std::uint32_t found = snapshot.column_element(clip, name); found != row_bytes)
    throw Error(ErrorKind::kDamaged, snapshot.clip(clip).name,
                std::string("column ") + name + " has rows of " + std::to_string(found) + " bytes, " +
                    std::to_string(row_bytes) + " expected for the number of words in the store's settings",
                "Build the index again: freshet index --rebuild");
  return {word_bytes, snapshot.records<std::byte>(clip, name, row_bytes)};
}

void PatchColumns::keep_first(std::size_t rows) {
  variant.resize(rows);
  x.resize(rows);
  y.resize(rows);
  motion.resize(rows);
  coverage.resize(rows);
  if (!words.empty()) words.resize(rows);
}

void begin_stream(store::ClipWriter& writer, store::Stream stream, const std::vector<cv::Mat>& planes) {
  std::vector<store::PlaneShape> shapes;
  for (const cv::Mat& plane : planes)
    shapes.push_back({static_cast<std::uint32_t>(plane.cols), static_cast<std::uint32_t>(plane.rows),
                      static_cast<std::uint8_t>(plane.elemSize1())});
  writer.begin_stream(stream, shapes);
}

void append(store::ClipWriter& writer, store::Stream stream, const std::vector<cv::Mat>& planes) {
  std::vector<store::PlaneView> views;
  for (const cv::Mat& plane : planes) views.push_back(view_of(plane));
  writer.append(stream, views);
}

void write_columns(store::ClipWriter& writer, const ClipColumns& columns) {
  if (!columns.average.empty()) {
    begin_stream(writer, store::Stream::kAverage, {columns.average});
    append(writer, store::Stream::kAverage, {columns.average});
  }
  write_unless_empty(writer, kFrameTime, columns.times_s);
  write_unless_empty(writer, kFlowRate, columns.rates);
  write_cells(writer, kMotionCells, columns.motion);
  for (std::size_t scale = 0; scale < columns.texture.size(); ++scale)
    write_cells(writer, texture_cells_name(scale), columns.texture[scale]);
  write_cells(writer, kLifeCells, columns.life);
  write_cells(writer, kStandingCells, columns.standing);
  write_cells(writer, kLayoutCells, columns.layout);
  write_unless_empty(writer, kFlowOutlier, columns.flow_outliers);
  write_unless_empty(writer, kPatchVariant, columns.patches.variant);
  write_unless_empty(writer, kPatchX, columns.patches.x);
  write_unless_empty(writer, kPatchY, columns.patches.y);
  write_unless_empty(writer, kPatchMotion, columns.patches.motion);
  write_unless_empty(writer, kPatchCoverage, columns.patches.coverage);
  if (const vision::OwnWordMaps& words = columns.patches.words; !words.empty())
    writer.column_bytes(kPatchWords.name, words.bytes(), static_cast<std::uint32_t>(words.row_bytes()));
}

}  // namespace freshet::stored
