#include "bench/choices/measured_cells.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <utility>

#include "freshet/error.h"
#include "media/frame/frame.h"
#include "stored/clip_columns.h"
#include "stored/clip_frames.h"
#include "vision/flow.h"
#include "vision/patch_features.h"
#include "vision/textureness.h"

namespace freshet::bench {
namespace {

namespace fs = std::filesystem;

std::uint64_t bytes_of(const store::Store& store, const std::string& what) {
  for (const auto& usage : store.snapshot().usage()) {
    if (usage.what == what) return usage.stored_bytes;
  }
  throw Error(ErrorKind::kNotFound, what, "the store does not say what it takes");
}

}  // namespace

Footage read_footage(const store::Snapshot& snapshot, store::ClipId id, std::uint32_t max_frames) {
  const stored::ClipFrames frames(snapshot, id);
  const store::ClipRecord& record = snapshot.clip(id);
  Footage footage;
  footage.fps = static_cast<double>(record.fps_num) / static_cast<double>(record.fps_den);
  for (const media::Frame& frame : frames.read(0, std::min(max_frames, frames.size()))) {
    footage.luma.push_back(media::to_luma(frame));
  }
  footage.flow.resize(footage.luma.size() - 1);
  oneapi::tbb::parallel_for(std::size_t{0}, footage.flow.size(), [&](std::size_t i) {
    footage.flow[i] = vision::optical_flow(footage.luma[i], footage.luma[i + 1]);
  });
  return footage;
}

void measure(const Footage& footage, const store::ClipRecord& record, const std::filesystem::path& folder,
             Measured& to) {
  const vision::Settings& settings = to.settings;
  const cv::Size size = footage.luma[0].size();
  const fs::path file = folder / "cells.freshet";
  store::Store store = store::Store::create(file, "");
  store::ClipWriter writer = store.add_clip();
  vision::MotionAccumulator motion(size, settings.flow_step, footage.fps, settings.spectrum);
  cv::Mat u, v;
  for (std::size_t i = 0; i < footage.flow.size(); ++i) {
    vision::quantize_flow(footage.flow[i], settings.flow_step, u, v);
    if (i == 0) stored::begin_stream(writer, store::Stream::kFlow, {u, v});
    stored::append(writer, store::Stream::kFlow, {u, v});
    motion.add(u, v);
  }
  stored::ClipColumns columns;
  columns.motion = motion.finish();
  for (const float scale : settings.scales) {
    vision::TexturenessAccumulator texture(size, scale, settings.texture_cell);
    for (const cv::Mat& luma : footage.luma) texture.add(luma);
    columns.texture.push_back(texture.finish());
  }
  stored::write_columns(writer, columns);
  to.motion.push_back(std::move(columns.motion));
  to.texture.push_back(std::move(columns.texture));
  store::ClipRecord copy = record;
  copy.frames = copy.flow = copy.average = {};
  writer.commit(copy);
  to.cells_mb += static_cast<double>(bytes_of(store, "columns")) / 1e6;
  to.flow_mb += static_cast<double>(bytes_of(store, "flow")) / 1e6;
  store = {};
  fs::remove(file);
  fs::remove(file.string() + "-lock");
}

query::FeatureSource source_of(const Measured& measured, const store::Snapshot& snapshot,
                               const stored::PatchTable& table) {
  const auto variants = measured.settings.variants();
  std::vector<std::vector<vision::VariantFrame>> frames;
  for (const store::ClipId id : table.clips) {
    const store::ClipRecord& record = snapshot.clip(id);
    frames.emplace_back();
    for (const vision::Variant& variant : variants) {
      frames.back().push_back(vision::variant_frame(
          cv::Size(static_cast<int>(record.width), static_cast<int>(record.height)), variant));
    }
  }
  const query::FeatureShape shape = query::feature_shape(measured.settings);
  const int side = shape.square() * measured.settings.spectrum.cell, across = shape.squares();
  return {[&table, side, across](stored::Row row, std::span<query::Square> out) {
            for (int k = 0; k < across * across; ++k)
              out[static_cast<std::size_t>(k)] = {
                  table.clip[row], table.variant[row],
                  static_cast<std::uint16_t>(table.y[row] + k / across * side),
                  static_cast<std::uint16_t>(table.x[row] + k % across * side)};
          },
          [&measured, variants, frames, shape, side](std::span<const query::Square> squares,
                                                     const query::SquareSink& sink) {
            const auto& scales = measured.settings.scales;
            oneapi::tbb::parallel_for(std::size_t{0}, squares.size(), [&](std::size_t i) {
              const query::Square& square = squares[i];
              const auto scale = std::find(scales.begin(), scales.end(), variants[square.variant].scale);
              std::vector<float> features(shape.square_values());
              vision::patch_features(
                  measured.motion[square.clip],
                  measured.texture[square.clip][static_cast<std::size_t>(scale - scales.begin())],
                  frames[square.clip][square.variant], square.x, square.y, side, measured.settings.spectrum,
                  features);
              sink(i, features);
            });
          }};
}

}  // namespace freshet::bench
