// tests/stored/made_store.h — a store of clips whose patches and motion are known, made without any video.
#pragma once

#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "store/store.h"
#include "stored/clip_columns.h"
#include "stored/clip_metadata.h"
#include "tests/harness/scratch_folder.h"
#include "vision/patch_features.h"
#include "vision/settings.h"

namespace freshet {

struct MadeClip {
  std::string name;
  std::string class_name = "water";
  cv::Vec2f motion{0, 30};  // px/s at source scale, x right, y down
  double seconds = 4;
  std::uint64_t texture = 1;  // seed of the average image
  bool patches = true;
  float surge = -1;       // power of u and of v in each of the two lowest bands, (px/s)^2; negative: chance
  double frame_s = 0.04;  // between the times of its frames; the record says 25 frames per second in any case
};

inline vision::Settings made_settings() {
  vision::Settings settings;
  settings.scales = {1.0f, 0.5f};
  settings.rotations_deg = {0.0f, 22.5f};
  settings.codebook.words = 40;
  settings.codebook.iterations = 4;
  return settings;
}

inline std::string source_hash_of(const MadeClip& clip) {
  return fmt::format("{:032x}", std::hash<std::string>()(clip.name));
}

/// Smooth noise with a grain of its own: CV_8U.
inline cv::Mat made_texture(std::uint64_t seed, cv::Size size = {192, 144}) {
  cv::RNG random(seed * 7919 + 1);
  cv::Mat noise(size, CV_8U);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::Mat smooth;
  cv::GaussianBlur(noise, smooth, {}, 1.5 + static_cast<double>(seed % 4),
                   1.0 + static_cast<double>(seed % 3));
  cv::normalize(smooth, smooth, 0, 255, cv::NORM_MINMAX);
  return smooth;
}

inline void add_made_clip(store::Store& store, const vision::Settings& settings, const MadeClip& made) {
  const cv::Mat texture = made_texture(made.texture);
  const auto width = static_cast<std::uint32_t>(texture.cols),
             height = static_cast<std::uint32_t>(texture.rows);
  store::ClipRecord record;
  record.name = made.name;
  record.class_name = made.class_name;
  record.licence = "CC0";
  record.source_hash = source_hash_of(made);
  record.pixel_format = "gray";
  record.width = width;
  record.height = height;
  record.fps_num = 25;

  store::ClipWriter writer = store.add_clip();
  const auto frames = static_cast<std::uint32_t>(std::lround(made.seconds * 25));
  stored::begin_stream(writer, store::Stream::kFrames, {texture});
  for (std::uint32_t frame = 0; frame < frames; ++frame)
    stored::append(writer, store::Stream::kFrames, {texture});
  stored::ClipColumns columns;
  texture.convertTo(columns.average, CV_16U, 257);

  // Everywhere the same motion, some power, some texture: enough to tell clips apart.
  std::mt19937_64 random(made.texture);
  const auto made_cells = [&](int channels, double cell, auto&& fill) {
    vision::CellMap cells{.rows = static_cast<int>(std::ceil(height / cell)),
                          .columns = static_cast<int>(std::ceil(width / cell)),
                          .channels = channels,
                          .cell = static_cast<float>(cell),
                          .values = {}};
    for (int i = 0; i < cells.rows * cells.columns; ++i) fill(cells.values);
    return cells;
  };
  const int bands = vision::motion_bands(settings.spectrum);
  columns.motion = made_cells(vision::motion_channels(settings.spectrum), settings.spectrum.cell,
                              [&](std::vector<float>& values) {
                                values.push_back(made.motion[0]);
                                values.push_back(made.motion[1]);
                                for (int b = 0; b < bands; ++b) {
                                  const auto power = static_cast<float>(random() % 1000);
                                  if (made.surge >= 0 && b < 2)
                                    values.insert(values.end(), {made.surge, made.surge, 0});
                                  else
                                    values.insert(values.end(), {power, power / 2, 0});
                                }
                              });
  for (const float scale : settings.scales)
    columns.texture.push_back(made_cells(vision::kTextureLevels,
                                         settings.texture_cell / static_cast<double>(scale),
                                         [&](std::vector<float>& values) {
                                           for (int l = 0; l < vision::kTextureLevels; ++l)
                                             values.push_back(static_cast<float>(random() % 100) / 1000);
                                         }));

  const auto variants = settings.variants();
  stored::PatchColumns& patches = columns.patches;
  for (std::size_t v = 0; made.patches && v < variants.size(); ++v) {
    const vision::VariantFrame frame = vision::variant_frame(texture.size(), variants[v]);
    const cv::Mat valid = vision::valid_mask(texture.size(), variants[v]);
    const auto positions = vision::patch_positions(frame.size, settings.grid, variants[v].flip);
    const auto inside = vision::patch_coverage(valid, positions, settings.grid.patch);
    const cv::Vec2d turned = frame.variant_from_source_velocity * cv::Vec2d(made.motion[0], made.motion[1]);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (inside[i] < 1) continue;
      patches.variant.push_back(static_cast<std::uint8_t>(v));
      patches.x.push_back(static_cast<std::uint16_t>(positions[i].x));
      patches.y.push_back(static_cast<std::uint16_t>(positions[i].y));
      patches.motion.push_back({static_cast<float>(turned[0]), static_cast<float>(turned[1])});
      patches.coverage.push_back(1);
    }
  }
  for (std::uint32_t frame = 0; frame < frames; ++frame) columns.times_s.push_back(frame * made.frame_s);
  stored::write_columns(writer, columns);
  const media::PixelLayout layout{
      .format = "gray", .width = texture.cols, .height = texture.rows, .range = 2};
  record.metadata = to_json(
      stored::ClipMetadata{.layout = layout, .cells = stored::shapes_of(columns), .loop_known = false});
  writer.commit(record);
}

inline store::Store made_store(const std::filesystem::path& path, const std::vector<MadeClip>& clips,
                               const vision::Settings& settings = made_settings()) {
  store::Store store = store::Store::create(path, vision::to_json(settings));
  for (const MadeClip& clip : clips) add_made_clip(store, settings, clip);
  return store;
}

inline std::vector<MadeClip> some_clips() {
  return {{.name = "fall.mp4", .motion = {0, 60}, .seconds = 4, .texture = 1},
          {.name = "river.mp4", .motion = {40, 0}, .seconds = 2, .texture = 2},
          {.name = "fire/camp.mp4", .class_name = "fire", .motion = {0, -50}, .seconds = 3, .texture = 3},
          {.name = "still.mp4", .motion = {0.5, 0}, .seconds = 6, .texture = 4}};
}

}  // namespace freshet
