#include "freshet/footage.h"

#include <algorithm>
#include <optional>

#include "freshet/error.h"
#include "library/states.h"
#include "media/frame/frame.h"
#include "stored/average_image.h"
#include "stored/clip_cells.h"
#include "stored/clip_frames.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "stored/store_settings.h"
#include "vision/flow.h"

namespace freshet {

struct Footage::Impl {
  Store store;
  std::size_t number;  // of the clip
  store::ClipId id;
  stored::ClipFrames frames;
  vision::Settings settings;
};

namespace {

cv::Mat stack(std::uint32_t count, int rows, int columns, int type) {
  const int shape[] = {static_cast<int>(count), rows, columns};
  return cv::Mat(3, shape, type);
}

cv::Mat stacked(const std::vector<cv::Mat>& pictures, cv::Size size, int type) {
  cv::Mat all = stack(static_cast<std::uint32_t>(pictures.size()), size.height, size.width, type);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    pictures[i].copyTo(cv::Mat(size, type, all.ptr(static_cast<int>(i))));
  return all;
}

void check_range(const std::string& clip, std::uint32_t first, std::uint32_t count, std::uint32_t there) {
  if (first > there || count > there - first)
    throw Error(ErrorKind::kUsage, clip,
                "frames " + std::to_string(first) + " to " + std::to_string(first + count) + " of " +
                    std::to_string(there));
}

// A column as it is known by name; `values` in a row.
template <class T>
std::optional<cv::Mat> read_if_named(const stored::Column<T>& column, const std::string& name, int values,
                                     int depth, const store::Snapshot& snapshot, store::ClipId clip) {
  if (name != column.name) return {};
  const std::vector<T> rows = column.read(snapshot, clip);
  static_assert(std::is_trivially_copyable_v<T>);
  return cv::Mat(static_cast<int>(rows.size()), values, depth, const_cast<T*>(rows.data())).clone();
}

const char* const kColumns[] = {stored::kFrameTime.name,     stored::kFlowRate.name,
                                stored::kPatchVariant.name,  stored::kPatchX.name,
                                stored::kPatchY.name,        stored::kPatchMotion.name,
                                stored::kPatchCoverage.name, stored::kPatchWords.name};

struct NamedCells {
  std::string name, column;
  stored::CellShape shape;
};

std::vector<NamedCells> cells_of(const store::Snapshot& snapshot, store::ClipId clip) {
  const stored::CellShapes shapes = stored::metadata_of(snapshot, clip).cells;
  std::vector<NamedCells> named;
  const auto add = [&](const std::string& name, const std::string& column,
                       const std::optional<stored::CellShape>& shape) {
    if (shape && snapshot.has_column(clip, column)) named.push_back({name, column, *shape});
  };
  add("motion", stored::kMotionCells, shapes.motion);
  add("life", stored::kLifeCells, shapes.life);
  add("standing", stored::kStandingCells, shapes.standing);
  for (std::size_t scale = 0; scale < shapes.texture.size(); ++scale)
    add("texture." + std::to_string(scale), stored::texture_cells_name(scale), shapes.texture[scale]);
  return named;
}

}  // namespace

Footage::Footage(const Store& store, const std::string& clip) {
  const store::Snapshot& snapshot = store.impl().snapshot;
  const std::optional<store::ClipId> id = snapshot.find(clip);
  if (!id)
    throw Error(ErrorKind::kNotFound, store.path().string(), "it has no clip \"" + clip + "\"",
                "Store::clips lists them");
  const auto ids = snapshot.clips();
  impl_ = std::make_shared<const Impl>(
      Impl{.store = store,
           .number = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), *id) - ids.begin()),
           .id = *id,
           .frames = stored::ClipFrames(snapshot, *id),
           .settings = stored::settings_of(snapshot)});
}

Clip Footage::clip() const { return impl_->store.clips().at(impl_->number); }

std::string Footage::pixel_format() const { return impl_->frames.layout().format; }

std::vector<cv::Mat> Footage::planes(std::uint32_t first, std::uint32_t count) const {
  const stored::ClipFrames& frames = impl_->frames;
  check_range(clip().name, first, count, frames.size());
  const std::vector<media::Frame> read = frames.read(first, count);
  std::vector<cv::Mat> planes;
  for (const media::Plane& shape : media::plane_shapes(frames.layout())) {
    const std::size_t number = planes.size();
    const int type = shape.bytes_per_sample == 1 ? CV_8U : CV_16U;
    planes.push_back(stack(count, shape.height, shape.width, type));
    for (std::uint32_t i = 0; i < count; ++i) {
      const media::Plane& plane = read[i].planes[number];
      cv::Mat(shape.height, shape.width, type, plane.data, static_cast<std::size_t>(plane.stride))
          .copyTo(cv::Mat(shape.height, shape.width, type, planes[number].ptr(static_cast<int>(i))));
    }
  }
  return planes;
}

cv::Mat Footage::bgr(std::uint32_t first, std::uint32_t count) const {
  const stored::ClipFrames& frames = impl_->frames;
  check_range(clip().name, first, count, frames.size());
  const cv::Size size(frames.layout().width, frames.layout().height);
  cv::Mat all = stack(count, size.height, size.width, CV_8UC3);
  constexpr std::uint32_t kSlab = 16;  // frames that are decoded together
  for (std::uint32_t at = 0; at < count; at += kSlab) {
    const std::vector<media::Frame> read = frames.read(first + at, std::min(kSlab, count - at));
    for (std::uint32_t i = 0; i < read.size(); ++i)
      media::to_bgr(read[i]).copyTo(cv::Mat(size, CV_8UC3, all.ptr(static_cast<int>(at + i))));
  }
  return all;
}

cv::Mat Footage::luma(std::uint32_t first, std::uint32_t count) const {
  const stored::ClipFrames& frames = impl_->frames;
  check_range(clip().name, first, count, frames.size());
  return stacked(frames.read_luma(first, count), {frames.layout().width, frames.layout().height}, CV_8U);
}

cv::Mat Footage::flow(std::uint32_t first, std::uint32_t count) const {
  const store::Snapshot& snapshot = impl_->store.impl().snapshot;
  const store::ClipRecord& record = snapshot.clip(impl_->id);
  check_range(record.name + ", flow", first, count, record.flow.frames);
  if (count == 0) return stack(0, 0, 0, CV_32FC2);
  const std::vector<store::PlaneShape>& shapes = record.flow.planes;
  if (shapes.size() != 2 || shapes[0] != shapes[1] || shapes[0].bytes_per_sample != 2)
    throw Error(ErrorKind::kDamaged, record.name, "its flow is not two planes of 16 bits",
                "Run freshet store verify");
  const int rows = static_cast<int>(shapes[0].height), columns = static_cast<int>(shapes[0].width);
  cv::Mat flow = stack(count, rows, columns, CV_32FC2);
  cv::Mat samples = stack(count, rows, columns, CV_16S);
  for (std::uint32_t plane = 0; plane < 2; ++plane) {
    snapshot.read(impl_->id, store::Stream::kFlow, plane, {0, 0, shapes[0].width, shapes[0].height}, first,
                  count, {reinterpret_cast<std::byte*>(samples.data), samples.total() * samples.elemSize()});
    const auto* from = samples.ptr<std::int16_t>();
    auto* to = flow.ptr<float>() + plane;
    for (std::size_t i = 0; i < samples.total(); ++i)
      to[2 * i] = static_cast<float>(from[i]) * vision::kFlowUnit;
  }
  return flow;
}

int Footage::flow_step() const { return impl_->settings.flow_step; }

cv::Mat Footage::average() const { return stored::average_image(impl_->store.impl().snapshot, impl_->id); }

std::vector<std::string> Footage::columns() const {
  std::vector<std::string> there;
  for (const char* name : kColumns)
    if (impl_->store.impl().snapshot.has_column(impl_->id, name)) there.emplace_back(name);
  return there;
}

cv::Mat Footage::column(const std::string& name) const {
  const store::Snapshot& snapshot = impl_->store.impl().snapshot;
  std::optional<cv::Mat> found;
  const auto look = [&](const auto& column, int values, int depth) {
    if (!found) found = read_if_named(column, name, values, depth, snapshot, impl_->id);
  };
  look(stored::kFrameTime, 1, CV_64F);
  look(stored::kFlowRate, 1, CV_64F);
  look(stored::kPatchVariant, 1, CV_8U);
  look(stored::kPatchX, 1, CV_16U);
  look(stored::kPatchY, 1, CV_16U);
  look(stored::kPatchMotion, 2, CV_32F);
  look(stored::kPatchCoverage, 1, CV_32F);
  if (name == stored::kPatchWords.name) {
    const int word_bytes = vision::word_bytes(impl_->settings.codebook.words);
    vision::OwnWordMaps words = stored::kPatchWords.read(snapshot, impl_->id, word_bytes);
    found = cv::Mat(static_cast<int>(words.size()), vision::kGridSide * vision::kGridSide,
                    word_bytes == 1 ? CV_8U : CV_16U, words.bytes().data())
                .clone();
  }
  if (!found)
    throw Error(ErrorKind::kNotFound, clip().name, "it has no column \"" + name + "\"",
                "Footage::columns lists them");
  return *found;
}

std::vector<std::string> Footage::cell_maps() const {
  std::vector<std::string> names;
  for (const NamedCells& cells : cells_of(impl_->store.impl().snapshot, impl_->id))
    names.push_back(cells.name);
  return names;
}

cv::Mat Footage::cells(const std::string& name) const {
  const store::Snapshot& snapshot = impl_->store.impl().snapshot;
  for (const NamedCells& named : cells_of(snapshot, impl_->id)) {
    if (named.name != name) continue;
    vision::CellMap map =
        stored::clip_cells(snapshot, impl_->id, named.column, named.shape, named.shape.channels);
    const int shape[] = {map.rows, map.columns, map.channels};
    return cv::Mat(3, shape, CV_32F, map.values.data()).clone();
  }
  throw Error(ErrorKind::kNotFound, clip().name, "it has no cells \"" + name + "\"",
              "Footage::cell_maps lists them");
}

std::vector<PatchVariant> variants(const Store& store) {
  std::vector<PatchVariant> variants;
  for (const vision::Variant& variant : stored::settings_of(store.impl().snapshot).variants())
    variants.push_back({variant.scale, variant.rotation_deg, variant.flip});
  return variants;
}

}  // namespace freshet
