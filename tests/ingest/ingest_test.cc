#include "ingest/ingest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <tbb/global_control.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "ingest/clip_analysis.h"
#include "media/video/frame_stamps.h"
#include "media/video/video_reader.h"
#include "media/video/video_writer.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "tests/harness/scratch_folder.h"
#include "tests/ingest/synthetic_clip.h"
#include "vision/detail_lifetime.h"
#include "vision/flow.h"
#include "vision/loop_rule.h"
#include "vision/textureness.h"

namespace freshet::ingest {
namespace {

namespace fs = std::filesystem;

const vision::Settings kSettings;

store::Store new_store(const fs::path& path) {
  return store::Store::create(path, vision::to_json(kSettings));
}

IngestReport run(store::Store& store, const fs::path& path, const IngestOptions& options = {}) {
  const fs::path paths[] = {path};
  return ingest(store, kSettings, paths, options);
}

std::string reason(const ClipReport& clip) { return clip.reasons.empty() ? "" : clip.reasons.front(); }

bool says(const std::vector<std::string>& sentences, const std::string& words) {
  return std::ranges::any_of(sentences,
                             [&](const std::string& s) { return s.find(words) != std::string::npos; });
}

/// A clip's file, a fresh store, and the row that came of it.
struct OneClip {
  ScratchFolder folder;
  store::Store store = new_store(folder / "test.freshet");
  ClipReport row;

  explicit OneClip(const SyntheticClip& clip, const IngestOptions& options = {}) {
    fs::create_directories(folder / "water");
    write_clip(folder / "water/clip.mkv", clip);
    row = run(store, folder / "water", options).clips.at(0);
  }
  store::Snapshot snapshot() const { return store.snapshot(); }
  store::ClipId id() const {
    if (row.outcome != Outcome::kAdded) throw std::runtime_error(reason(row));
    return store.snapshot().clips()[0];
  }
};

TEST(Ingest, StoresFramesAsTheDecoderGaveThem) {
  const OneClip one({.size = {195, 147}});
  ASSERT_EQ(one.row.outcome, Outcome::kAdded) << reason(one.row);
  const store::Snapshot snapshot = one.snapshot();
  const store::ClipId id = one.id();
  const store::ClipRecord& record = snapshot.clip(id);
  EXPECT_EQ(record.name, "clip.mkv");
  EXPECT_EQ(record.class_name, "water");
  EXPECT_EQ(record.frame_count, 40u);
  EXPECT_EQ(record.width, 195u);

  media::VideoReader reader(one.folder / "water/clip.mkv");
  const std::vector<double> times = stored::kFrameTime.read(snapshot, id);
  ASSERT_EQ(times.size(), 40u);
  std::vector<std::byte> stored;
  for (std::uint32_t t = 0; t < 40; ++t) {
    const media::Frame frame = reader.next().value();
    EXPECT_EQ(times[t], frame.time_s);
    ASSERT_EQ(frame.planes.size(), record.frames.planes.size());
    for (std::uint32_t p = 0; p < frame.planes.size(); ++p) {
      const store::PlaneShape& shape = record.frames.planes[p];
      const std::size_t row_bytes = shape.width * shape.bytes_per_sample;
      stored.resize(row_bytes * shape.height);
      snapshot.read(id, store::Stream::kFrames, p, {0, 0, shape.width, shape.height}, t, 1, stored);
      for (std::uint32_t y = 0; y < shape.height; ++y) {
        ASSERT_TRUE(std::equal(stored.begin() + y * row_bytes, stored.begin() + (y + 1) * row_bytes,
                               frame.planes[p].data + y * frame.planes[p].stride))
            << "frame " << t << " plane " << p << " row " << y;
      }
    }
  }
  EXPECT_FALSE(reader.next().has_value());
}

TEST(Ingest, KeepsWhereAClipCanBeJoinedToItself) {
  const OneClip one({.frames = 40, .velocity = {6, 0}});
  const auto loop = nlohmann::json::parse(one.snapshot().clip(one.id()).metadata).at("loop");
  vision::LoopFinder finder(25);
  for (const cv::Mat& frame : render({.frames = 40, .velocity = {6, 0}})) finder.add(frame);
  const auto rule = finder.finish().value();
  EXPECT_EQ(loop.at("from"), rule.from);
  EXPECT_EQ(loop.at("to"), rule.to);
  EXPECT_EQ(loop.at("fade"), rule.fade);
  EXPECT_EQ(loop.at("distance"), rule.distance);
}

TEST(Ingest, SaysOfAClipThatItIsTooShortToBeJoined) {
  const OneClip one({.frames = 12}, {.force = true});
  EXPECT_TRUE(nlohmann::json::parse(one.snapshot().clip(one.id()).metadata).at("loop").is_null());
}

TEST(Ingest, StoresTheFlowOfEveryPairAlsoAcrossSlabs) {
  const SyntheticClip clip;
  const OneClip one(clip);
  const store::Snapshot snapshot = one.snapshot();
  const store::ClipId id = one.id();
  const store::StreamShape& shape = snapshot.clip(id).flow;
  ASSERT_EQ(shape.frames, 39u);
  ASSERT_EQ(shape.planes.size(), 2u);
  const std::vector<cv::Mat> frames = render(clip);
  for (const std::uint32_t t : {0u, 14u, 15u, 16u, 38u}) {
    cv::Mat u, v;
    vision::quantize_flow(vision::optical_flow(frames[t], frames[t + 1], kSettings.flow), kSettings.flow_step,
                          u, v);
    ASSERT_EQ(shape.planes[0].width, static_cast<std::uint32_t>(u.cols));
    ASSERT_EQ(shape.planes[0].height, static_cast<std::uint32_t>(u.rows));
    cv::Mat stored(u.size(), CV_16S);
    for (const auto& [plane, want] : {std::pair{0u, u}, {1u, v}}) {
      snapshot.read(id, store::Stream::kFlow, plane, {0, 0, shape.planes[0].width, shape.planes[0].height}, t,
                    1, {reinterpret_cast<std::byte*>(stored.data), stored.total() * 2});
      EXPECT_EQ(cv::norm(stored, want, cv::NORM_INF), 0) << "pair " << t;
    }
  }
}

TEST(Ingest, StoresTheMeanOfLumaAsTheAverage) {
  const SyntheticClip clip;
  const OneClip one(clip);
  const store::Snapshot snapshot = one.snapshot();
  cv::Mat sum = cv::Mat::zeros(clip.size, CV_64F);
  for (const cv::Mat& frame : render(clip)) cv::accumulate(frame, sum);
  cv::Mat stored(clip.size, CV_16U);
  snapshot.read(one.id(), store::Stream::kAverage, 0, {0, 0, 192, 144}, 0, 1,
                {reinterpret_cast<std::byte*>(stored.data), stored.total() * 2});
  cv::Mat difference = cv::Mat(sum / 40 * 257);
  stored.convertTo(stored, CV_64F);
  EXPECT_LE(cv::norm(difference, stored, cv::NORM_INF), 0.51);
}

TEST(Ingest, KeepsPatchesOnlyWhereItMoves) {
  const SyntheticClip clip{.size = {320, 240}, .moving = {40, 40, 160, 120}};
  const OneClip one(clip);
  ASSERT_EQ(one.row.outcome, Outcome::kAdded) << reason(one.row);
  const store::Snapshot snapshot = one.snapshot();
  const store::ClipId id = one.id();
  const auto variant = stored::kPatchVariant.read(snapshot, id);
  const auto x = stored::kPatchX.read(snapshot, id), y = stored::kPatchY.read(snapshot, id);
  const auto coverage = stored::kPatchCoverage.read(snapshot, id);
  ASSERT_EQ(variant.size(), one.row.patches);
  const std::vector<vision::Variant> variants = kSettings.variants();
  cv::Mat truth = cv::Mat::zeros(clip.size, CV_8U);
  truth(clip.moving).setTo(255);

  std::vector<int> seen(variants.size());
  for (std::size_t i = 0; i < variant.size(); ++i) {
    ++seen[variant[i]];
    EXPECT_GE(coverage[i], kSettings.min_coverage);
    const vision::VariantFrame frame = vision::variant_frame(clip.size, variants[variant[i]]);
    int inside = 0;
    for (int dy = 0; dy < 48; ++dy) {
      for (int dx = 0; dx < 48; ++dx) {
        const cv::Vec2d at = frame.source_from_variant * cv::Vec3d(x[i] + dx, y[i] + dy, 1);
        inside += clip.moving.contains(cv::Point(cvRound(at[0]), cvRound(at[1])));
      }
    }
    // Flow bleeds over the edge of what moves, but the change of luma does not: a pixel or two.
    EXPECT_NEAR(inside / (48.0 * 48), coverage[i], 0.12) << "variant " << int(variant[i]);
  }
  for (std::size_t v = 0; v < variants.size(); ++v) {
    EXPECT_EQ(one.row.patches_by_variant[v], static_cast<std::uint64_t>(seen[v]));
    EXPECT_GT(seen[v], 0) << "variant " << v;
  }
  // Without rotation the grid and the rectangle are known: count its patches.
  int expected = 0;
  for (const cv::Point& at : vision::patch_positions(clip.size, kSettings.grid)) {
    expected += (cv::Rect(at, cv::Size(48, 48)) & clip.moving).area() >= 48 * 48 / 2;
  }
  const auto plain = std::ranges::find(variants, vision::Variant{1, 0, false}) - variants.begin();
  EXPECT_NEAR(seen[plain], expected, 2);
}

TEST(Ingest, TakesNoPatchFromThePathOfWhatCrosses) {
  const SyntheticClip still{.size = {320, 240}, .frames = 160, .moving = {60, 20, 200, 200}};
  SyntheticClip walked = still;
  walked.crossed = true;
  const OneClip one(still), other(walked);
  ASSERT_EQ(one.row.outcome, Outcome::kAdded) << reason(one.row);
  ASSERT_EQ(other.row.outcome, Outcome::kAdded) << reason(other.row);
  EXPECT_EQ(one.row.screening.crossed_fraction, 0);
  EXPECT_FALSE(says(one.row.notes, "something crosses it"));
  EXPECT_GT(other.row.screening.crossed_fraction, 0.05);
  EXPECT_TRUE(says(other.row.notes, "something crosses it"));
  EXPECT_LT(other.row.patches, one.row.patches);
  const nlohmann::json metadata = nlohmann::json::parse(other.snapshot().clip(other.id()).metadata);
  EXPECT_EQ(metadata.at("screening").at("crossed_share"), other.row.screening.crossed_fraction);
}

TEST(Ingest, PatchMotionIsTheTextureVelocityTurnedIntoEachVariant) {
  const SyntheticClip clip{.size = {320, 240}, .moving = {20, 20, 280, 200}, .velocity = {1.5, -0.5}};
  // Forced: a texture that fills the frame and does not change is what a panning camera shows.
  const OneClip one(clip, {.force = true});
  const store::Snapshot snapshot = one.snapshot();
  const store::ClipId id = one.id();
  const auto variant = stored::kPatchVariant.read(snapshot, id);
  const auto x = stored::kPatchX.read(snapshot, id), y = stored::kPatchY.read(snapshot, id);
  const auto motion = stored::kPatchMotion.read(snapshot, id);
  const std::vector<vision::Variant> variants = kSettings.variants();
  std::vector<int> judged(variants.size());
  const cv::Rect well_inside(clip.moving.x + 8, clip.moving.y + 8, clip.moving.width - 16,
                             clip.moving.height - 16);
  for (std::size_t i = 0; i < variant.size(); ++i) {
    const vision::VariantFrame frame = vision::variant_frame(clip.size, variants[variant[i]]);
    bool inside = true;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {47, 0}, {0, 47}, {47, 47}}) {
      const cv::Vec2d at = frame.source_from_variant * cv::Vec3d(x[i] + dx, y[i] + dy, 1);
      inside = inside && well_inside.contains(cv::Point(cvRound(at[0]), cvRound(at[1])));
    }
    if (!inside) continue;
    ++judged[variant[i]];
    const cv::Vec2d truth = frame.variant_from_source_velocity * (clip.velocity * 25.0);
    EXPECT_NEAR(motion[i][0], truth[0], 0.1 * cv::norm(truth)) << "variant " << int(variant[i]);
    EXPECT_NEAR(motion[i][1], truth[1], 0.1 * cv::norm(truth)) << "variant " << int(variant[i]);
  }
  for (std::size_t v = 0; v < variants.size(); ++v) EXPECT_GT(judged[v], 0) << "variant " << v;
}

/// A clip of which only these frames are left, each with its own time. By the ffmpeg tool, which selects them.
bool write_with_gaps(const fs::path& path, const SyntheticClip& clip, const std::string& selected) {
  const fs::path whole = path.parent_path().parent_path() / "whole.mkv";
  write_clip(whole, clip);
  const std::string command = "ffmpeg -v error -i '" + whole.string() + "' -vf \"select='" + selected +
                              "'\" -vsync vfr -c:v ffv1 '" + path.string() + "'";
  return std::system(command.c_str()) == 0;
}

/// Of the cells in which the texture scrolls: its mean velocity, px/s, and how much its speed along x varies, (px/s)^2.
struct ScrollMotion {
  cv::Vec2d velocity{0, 0};
  double varies = 0;
};

ScrollMotion scroll_motion(const store::Snapshot& snapshot, store::ClipId id, const cv::Rect& inside) {
  const nlohmann::json shape = nlohmann::json::parse(snapshot.clip(id).metadata).at("cells").at("motion");
  const auto channels = static_cast<std::size_t>(vision::motion_channels(kSettings.spectrum));
  const auto values = snapshot.column<std::array<float, 2 + 3 * 8>>(id, "cells.motion");
  EXPECT_EQ(channels, values.front().size());
  const int side = kSettings.spectrum.cell, columns = shape.at("columns");
  ScrollMotion motion;
  int cells = 0;
  for (int y = inside.y / side + 1; y < inside.br().y / side; ++y)
    for (int x = inside.x / side + 1; x < inside.br().x / side; ++x, ++cells) {
      const auto& cell = values[static_cast<std::size_t>(y * columns + x)];
      motion.velocity += cv::Vec2d(cell[0], cell[1]);
      for (std::size_t band = 0; band < 8; ++band) motion.varies += cell[2 + 3 * band];
    }
  return {motion.velocity / cells, motion.varies / cells};
}

TEST(Ingest, AVariableFrameRateKeepsItsTimesAndItsSpeeds) {
  const SyntheticClip clip{
      .size = {320, 240}, .frames = 96, .moving = {20, 20, 280, 200}, .velocity = {1.5, -0.5}};
  const ScratchFolder folder;
  fs::create_directories(folder / "water");
  // Two thirds of each second lack every other frame, as a phone's do where it gets dark.
  if (!write_with_gaps(folder / "water/clip.mkv", clip, "lt(mod(n,24),8)+not(mod(n,2))"))
    GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  store::Store store = new_store(folder / "test.freshet");
  const ClipReport row = run(store, folder / "water", {.force = true}).clips.at(0);
  ASSERT_EQ(row.outcome, Outcome::kAdded) << reason(row);
  EXPECT_TRUE(says(row.notes, "its frame rate varies from 12.5 to 25.0 frames/s"));
  EXPECT_NEAR(row.fps, 63 / 3.76, 0.01);
  const store::Snapshot snapshot = store.snapshot();
  const store::ClipId id = snapshot.clips()[0];
  const std::vector<double> times = stored::kFrameTime.read(snapshot, id),
                            rates = snapshot.column<double>(id, "flow.rate");
  ASSERT_EQ(times.size(), 64u);
  ASSERT_EQ(rates.size(), 63u);
  for (std::size_t t = 0; t < 63; ++t) {
    EXPECT_NEAR(times[t], static_cast<double>(t / 16 * 24 + (t % 16 < 8 ? t % 16 : 2 * (t % 16) - 8)) / 25,
                1e-9);
    EXPECT_NEAR(rates[t], t % 16 < 8 ? 25 : 12.5, 1e-6) << t;
  }
  // All of it moves equally fast all the time, though some pairs of frames lie twice as far apart as others.
  const ScrollMotion motion = scroll_motion(snapshot, id, cv::Rect(40, 40, 240, 160));
  EXPECT_NEAR(motion.velocity[0], 37.5, 2);
  EXPECT_NEAR(motion.velocity[1], -12.5, 2);
  EXPECT_LT(motion.varies, 0.02 * 37.5 * 37.5);
}

TEST(Ingest, ALongGapIsNoMotion) {
  const ScratchFolder folder;
  fs::create_directories(folder / "water");
  if (!write_with_gaps(folder / "water/clip.mkv", {.frames = 60, .changing = true}, "lt(n,25)+gt(n,40)"))
    GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  store::Store store = new_store(folder / "test.freshet");
  const IngestReport parts = run(store, folder / "water");
  ASSERT_EQ(parts.clips.size(), 2u) << "it is cut there";
  EXPECT_EQ(parts.clips[0].name, "clip.mkv@0.000-1.000");
  EXPECT_EQ(parts.clips[0].outcome, Outcome::kAdded);
  EXPECT_EQ(parts.clips[1].name, "clip.mkv@1.640-2.400");
  EXPECT_TRUE(says(parts.clips[1].reasons, "19 frames"));
  store::Store forced = new_store(folder / "forced.freshet");
  const ClipReport row = run(forced, folder / "water", {.force = true}).clips.at(0);
  EXPECT_EQ(row.outcome, Outcome::kAdded);
  EXPECT_TRUE(says(row.reasons, "frames are missing: none for 0.68 s after 0.96 s"));
}

TEST(Ingest, AnUnsteadyStampIsNoVariableRate) {
  const OneClip one({.fps = 30});  // Matroska rounds to a millisecond
  ASSERT_EQ(one.row.outcome, Outcome::kAdded) << reason(one.row);
  EXPECT_TRUE(one.row.screening.timing.steady);
  EXPECT_FALSE(one.snapshot().has_column(one.id(), "flow.rate"));
  EXPECT_EQ(one.row.fps, 30);
}

TEST(Ingest, AnInterlacedClipHasTheRateOfItsFrames) {
  const ScratchFolder folder;
  fs::create_directories(folder / "water");
  const fs::path whole = folder / "whole.mkv";
  write_clip(whole, {.frames = 60, .fps = 50, .changing = true});
  const std::string command = "ffmpeg -v error -i '" + whole.string() +
                              "' -vf interlace -c:v mpeg2video -flags +ilme+ildct -b:v 8M '" +
                              (folder / "water/clip.ts").string() + "'";
  if (std::system(command.c_str()) != 0) GTEST_SKIP() << "needs the ffmpeg tool: apt-get install ffmpeg";
  EXPECT_TRUE(media::frame_stamps(folder / "water/clip.ts").empty()) << "they may be those of fields";
  store::Store store = new_store(folder / "test.freshet");
  const ClipReport row = run(store, folder / "water", {.force = true}).clips.at(0);
  ASSERT_EQ(row.outcome, Outcome::kAdded) << reason(row);
  EXPECT_EQ(row.fps, 25);
  EXPECT_TRUE(row.screening.timing.steady);
}

TEST(Ingest, KeepsCellsAndTheirShapes) {
  const OneClip one(SyntheticClip{});
  const store::Snapshot snapshot = one.snapshot();
  const store::ClipId id = one.id();
  const nlohmann::json metadata = nlohmann::json::parse(snapshot.clip(id).metadata);
  const auto check = [&](const std::string& column, const nlohmann::json& shape, int channels) {
    EXPECT_EQ(shape.at("channels"), channels);
    ASSERT_TRUE(snapshot.has_column(id, column));
    EXPECT_GT(shape.at("rows").get<int>() * shape.at("columns").get<int>(), 0);
  };
  check("cells.motion", metadata.at("cells").at("motion"), vision::motion_channels(kSettings.spectrum));
  for (std::size_t i = 0; i < kSettings.scales.size(); ++i) {
    check("cells.texture." + std::to_string(i), metadata.at("cells").at("texture").at(i),
          vision::kTextureLevels);
  }
  using TextureCell = std::array<float, vision::kTextureLevels>;
  const auto cells = snapshot.column<TextureCell>(id, "cells.texture.0");
  const nlohmann::json& shape = metadata.at("cells").at("texture").at(0);
  EXPECT_EQ(cells.size(), shape.at("rows").get<std::size_t>() * shape.at("columns").get<std::size_t>());
  EXPECT_EQ(stored::metadata_of(snapshot, id).layout.value().width, 192);
  EXPECT_EQ(metadata.at("screening").at("frames"), 40);
}

TEST(Ingest, KeepsHowLongDetailLivesAlongTheFlowThatIsKept) {
  const SyntheticClip clip{.changing = true};
  const OneClip one(clip);
  const store::Snapshot snapshot = one.snapshot();
  const store::ClipId id = one.id();
  const store::PlaneShape shape = snapshot.clip(id).flow.planes[0];
  vision::DetailLifetimeAccumulator life(clip.size, kSettings.flow_step, clip.fps);
  vision::MotionAccumulator motion(clip.size, kSettings.flow_step, clip.fps, kSettings.spectrum);
  LumaStatistics statistics(clip.size);
  const std::vector<cv::Mat> frames = render(clip);
  for (std::uint32_t i = 0; i < frames.size(); ++i) {
    statistics.add(frames[i]);
    if (i == 0) {
      life.begin(frames[i]);
      continue;
    }
    std::array<cv::Mat, 2> flow;
    for (std::uint32_t p = 0; p < 2; ++p) {
      flow[p].create(static_cast<int>(shape.height), static_cast<int>(shape.width), CV_16S);
      snapshot.read(id, store::Stream::kFlow, p, {0, 0, shape.width, shape.height}, i - 1, 1,
                    {reinterpret_cast<std::byte*>(flow[p].data), flow[p].total() * 2});
    }
    motion.add(flow[0], flow[1]);
    life.add(flow[0], flow[1], frames[i]);
  }
  const vision::DetailLifetimes expected =
      life.finish(moving_mask(motion.mean_speed_px(), statistics.deviation(), clip.fps, kSettings));
  EXPECT_GT(expected.clip[1], 0);
  EXPECT_EQ(snapshot.records<float>(id, "cells.life", vision::kLifeChannels), expected.cells.values);
  EXPECT_EQ(snapshot.column<vision::FlowOutlier>(id, "flow.outlier"), expected.flow_outliers);
  const nlohmann::json metadata = nlohmann::json::parse(snapshot.clip(id).metadata);
  EXPECT_EQ(metadata.at("half_life_s"), nlohmann::json(expected.clip));
  const nlohmann::json& cells = metadata.at("cells").at("life");
  EXPECT_EQ(cells.at("rows"), 5);
  EXPECT_EQ(cells.at("columns"), 6);
  EXPECT_EQ(cells.at("channels"), vision::kLifeChannels);
  EXPECT_EQ(cells.at("cell"), vision::kLifeCell);
}

TEST(Ingest, TakesColouredAndTransparentClips) {
  const ScratchFolder folder;
  media::VideoWriter writer(folder / "alpha.mkv", {192, 144});
  for (const cv::Mat& frame : render({})) {
    const cv::Mat alpha(frame.size(), CV_8U, cv::Scalar(200));
    cv::Mat bgra;
    cv::merge(std::vector<cv::Mat>{frame, 255 - frame, frame, alpha}, bgra);
    writer.write(bgra);
  }
  writer.finish();
  store::Store store = new_store(folder / "test.freshet");
  const ClipReport row = run(store, folder / "alpha.mkv").clips.at(0);
  EXPECT_EQ(row.outcome, Outcome::kAdded) << reason(row);
  EXPECT_GE(store.snapshot().clip(store.snapshot().clips()[0]).frames.planes.size(), 1u);
}

TEST(Ingest, TakesAPictureSequenceForAClip) {
  const ScratchFolder folder;
  fs::create_directories(folder / "clips/fire/burst");
  write_clip(folder / "clips/fire/burst/f%03d.png", {});
  store::Store store = new_store(folder / "test.freshet");
  const ClipReport row = run(store, folder / "clips").clips.at(0);
  EXPECT_EQ(row.outcome, Outcome::kAdded) << reason(row);
  EXPECT_EQ(row.name, "fire/burst");
  EXPECT_EQ(row.frames, 40u);
}

TEST(Ingest, ASecondRunAddsNothing) {
  const ScratchFolder folder;
  fs::create_directories(folder / "water");
  write_clip(folder / "water/a.mkv", {});
  write_clip(folder / "water/b.mkv", {.seed = 2});
  store::Store store = new_store(folder / "test.freshet");
  EXPECT_EQ(run(store, folder / "water").count(Outcome::kAdded), 2u);
  const std::string digest = store.snapshot().digest();
  const IngestReport again = run(store, folder / "water");
  EXPECT_EQ(again.count(Outcome::kAlreadyThere), 2u);
  EXPECT_EQ(store.snapshot().digest(), digest);

  fs::rename(folder / "water/a.mkv", folder / "water/renamed.mkv");
  EXPECT_TRUE(says(run(store, folder / "water").clips[1].reasons, "as \"a.mkv\"")) << "known by content";
}

TEST(Ingest, ANameWithOtherContentIsAnErrorUnlessNamesAreSkipped) {
  OneClip one(SyntheticClip{});
  write_clip(one.folder / "water/clip.mkv", {.seed = 9});
  const ClipReport clash = run(one.store, one.folder / "water").clips.at(0);
  EXPECT_EQ(clash.outcome, Outcome::kFailed);
  EXPECT_TRUE(says(clash.reasons, "another clip named"));
  const ClipReport skipped = run(one.store, one.folder / "water", {.skip_existing = true}).clips.at(0);
  EXPECT_EQ(skipped.outcome, Outcome::kAlreadyThere);
  EXPECT_EQ(skipped.seconds.hash, 0);
}

TEST(Ingest, DuplicatesInOneRunAreTakenOnceAndSaid) {
  const ScratchFolder folder;
  fs::create_directories(folder / "water");
  write_clip(folder / "water/a.mkv", {});
  fs::copy_file(folder / "water/a.mkv", folder / "water/b.mkv");
  SyntheticClip cut{.cut_at = 20};
  write_clip(folder / "water/c.mkv", cut);
  fs::copy_file(folder / "water/c.mkv", folder / "water/d.mkv");
  store::Store store = new_store(folder / "test.freshet");
  const IngestReport report = run(store, folder / "water");
  EXPECT_EQ(report.clips[0].outcome, Outcome::kAdded);
  EXPECT_EQ(report.clips[1].outcome, Outcome::kAlreadyThere);
  EXPECT_TRUE(says(report.clips[1].reasons, "\"a.mkv\" of this run"));
  EXPECT_EQ(report.clips[2].outcome, Outcome::kRefused);
  EXPECT_EQ(report.clips[3].outcome, Outcome::kRefused);
  EXPECT_TRUE(says(report.clips[3].reasons, "\"c.mkv\" of this run"));
}

/// The clip again, darker and smaller, and from another moment on, as a second file and as a film of its own.
TEST(Ingest, NearDuplicatesOfTheStoreAndOfTheRunAreSaid) {
  const SyntheticClip shown{
      .size = {384, 216}, .moving = {60, 40, 280, 160}, .changing = true, .coarse = true};
  OneClip one(shown);
  EXPECT_FALSE(one.row.alike);
  fs::create_directories(one.folder / "more");
  SyntheticClip later = shown;
  later.start = 500;
  write_clip(one.folder / "more/later.mkv", later);
  const auto write_copy = [&](const char* name, int side) {
    std::vector<cv::Mat> copy = render(shown);
    const cv::Size size(side, side * 9 / 16);
    media::VideoWriter writer(one.folder / name, size);
    for (cv::Mat& luma : copy) {
      cv::resize(luma, luma, size, 0, 0, cv::INTER_AREA);
      luma *= 0.8;
      cv::cvtColor(luma, luma, cv::COLOR_GRAY2BGR);
      writer.write(luma);
    }
    writer.finish();
  };
  write_copy("more/copy.mkv", 256);
  write_copy("more/small.mkv", 192);
  const auto expect_said = [](const IngestReport& report) {
    ASSERT_EQ(report.clips.size(), 3u);
    ASSERT_TRUE(report.clips[0].alike);
    EXPECT_EQ(report.clips[0].alike->name, "clip.mkv");
    EXPECT_NEAR(report.clips[0].alike->seconds, 40.0 / 25, 0.05);
    EXPECT_TRUE(says(report.clips[0].notes, "\"clip.mkv\""));
    EXPECT_FALSE(report.clips[1].alike) << "another moment of the scene";
    EXPECT_TRUE(report.clips[2].alike);
  };
  const fs::path paths[] = {one.folder / "more"};
  expect_said(preview(&one.store, kSettings, paths));
  expect_said(run(one.store, one.folder / "more"));
  EXPECT_EQ(one.snapshot().clips().size(), 4u);
  std::filesystem::remove(one.folder / "more/later.mkv");
  const IngestReport alone = preview(nullptr, kSettings, paths);
  EXPECT_FALSE(alone.clips.at(0).alike);
  ASSERT_TRUE(alone.clips.at(1).alike);
  EXPECT_EQ(alone.clips.at(1).alike->name, "copy.mkv");
}

TEST(Ingest, AStopRequestDropsTheClipInHandAndARestartGoesOn) {
  const ScratchFolder folder;
  fs::create_directories(folder / "water");
  write_clip(folder / "water/a.mkv", {});
  write_clip(folder / "water/b.mkv", {.seed = 2});
  store::Store store = new_store(folder / "test.freshet");
  const fs::path paths[] = {folder / "water"};
  std::stop_source stop;
  const IngestReport report = ingest(
      store, kSettings, paths, {},
      [&](const IngestProgress& at) {
        if (at.clip == 1 && at.frames >= 16) stop.request_stop();
      },
      stop.get_token());
  ASSERT_TRUE(report.stopped.has_value());
  EXPECT_EQ(report.stopped->kind(), ErrorKind::kCancelled);
  EXPECT_EQ(report.clips.size(), 1u);
  EXPECT_EQ(store.snapshot().clips().size(), 1u);
  EXPECT_TRUE(store.snapshot().verify().empty());
  const IngestReport rest = run(store, folder / "water");
  EXPECT_EQ(rest.clips[0].outcome, Outcome::kAlreadyThere);
  EXPECT_EQ(rest.clips[1].outcome, Outcome::kAdded);
}

TEST(Ingest, ProgressCountsFramesAndEndsEachClipWithItsRow) {
  const ScratchFolder folder;
  write_clip(folder / "a.mkv", {});
  store::Store store = new_store(folder / "test.freshet");
  const fs::path paths[] = {folder / "a.mkv"};
  std::vector<std::uint32_t> first_look, frames;
  int finished = 0;
  ingest(store, kSettings, paths, {}, [&](const IngestProgress& at) {
    (at.surveying ? first_look : frames).push_back(at.frames);
    EXPECT_EQ(at.clips, 1u);
    EXPECT_EQ(at.source->name, "a.mkv");
    if (at.finished) {
      ++finished;
      EXPECT_EQ(at.finished->outcome, Outcome::kAdded);
    }
  });
  EXPECT_EQ(first_look, (std::vector<std::uint32_t>{16, 32, 40}));
  EXPECT_EQ(frames, (std::vector<std::uint32_t>{0, 16, 32, 40, 40}));
  EXPECT_EQ(finished, 1);
}

TEST(Ingest, TheDigestDependsNeitherOnThreadsNorOnOrderNorOnShards) {
  const ScratchFolder folder;
  std::vector<fs::path> paths;
  for (int i = 0; i < 3; ++i) {
    paths.push_back(folder / ("clip" + std::to_string(i) + ".mkv"));
    write_clip(paths.back(),
               {.size = {160 + 2 * i, 120}, .frames = 36 + i, .moving = {20, 20, 120, 80}, .seed = 7u + i});
  }
  const auto digest = [&](int threads, const char* name, const std::vector<fs::path>& given) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    store::Store store = new_store(folder / name);
    EXPECT_EQ(ingest(store, kSettings, given).count(Outcome::kAdded), given.size());
    return store.snapshot().digest();
  };
  const std::string two = digest(2, "two", paths);
  EXPECT_EQ(digest(1, "one", paths), two);
  EXPECT_EQ(digest(8, "eight", {paths.rbegin(), paths.rend()}), two);

  store::Store sharded = new_store(folder / "sharded");
  for (const int index : {2, 1}) {
    EXPECT_FALSE(ingest(sharded, kSettings, paths, {.shard = {index, 2}}).stopped);
  }
  EXPECT_EQ(sharded.snapshot().digest(), two);
}

TEST(Ingest, RefusesAPanAndAJitterAndForceOverrides) {
  const OneClip pan({.frames = 60, .pan = {0.5, 0}});
  EXPECT_EQ(pan.row.outcome, Outcome::kRefused);
  EXPECT_TRUE(says(pan.row.reasons, "camera moves"));
  EXPECT_TRUE(pan.snapshot().clips().empty());
  const OneClip jitter({.jitter = 4});
  EXPECT_EQ(jitter.row.outcome, Outcome::kRefused);
  EXPECT_TRUE(says(jitter.row.reasons, "camera shakes"));
  const OneClip forced({.frames = 60, .pan = {0.5, 0}}, {.force = true});
  EXPECT_EQ(forced.row.outcome, Outcome::kAdded);
  EXPECT_TRUE(says(forced.row.reasons, "camera moves")) << "what was overridden is still said";
  const nlohmann::json metadata = nlohmann::json::parse(forced.snapshot().clip(forced.id()).metadata);
  EXPECT_EQ(metadata.at("screening").at("overridden").size(), forced.row.reasons.size());
}

TEST(Ingest, RefusesACutAndAShortClip) {
  const OneClip cut({.cut_at = 20});
  EXPECT_EQ(cut.row.outcome, Outcome::kRefused);
  EXPECT_TRUE(says(cut.row.reasons, "2 takes, none of which is fit"));
  EXPECT_TRUE(says(cut.row.reasons, "0.80 to 1.60 s: the clip is too short: 20 frames"));
  const OneClip forced({.cut_at = 20}, {.force = true});
  EXPECT_EQ(forced.row.outcome, Outcome::kAdded);
  EXPECT_TRUE(says(forced.row.reasons, "at frame 20"));
  const OneClip brief({.frames = 23});
  EXPECT_EQ(brief.row.outcome, Outcome::kRefused);
  EXPECT_TRUE(says(brief.row.reasons, "23 frames"));
}

TEST(Ingest, FailsEvenWhenForcedWhereThereIsNothingToKeep) {
  const IngestOptions force{.force = true};
  const OneClip one({.frames = 1}, force);
  EXPECT_EQ(one.row.outcome, Outcome::kFailed);
  EXPECT_TRUE(says(one.row.reasons, "only 1 frame,")) << reason(one.row);
  const OneClip eight({.frames = 8}, force);
  EXPECT_TRUE(says(eight.row.reasons, "only 8 frames,")) << reason(eight.row);
  const OneClip nine({.frames = 9}, force);
  EXPECT_EQ(nine.row.outcome, Outcome::kAdded) << reason(nine.row);
  const OneClip tiny({.size = {16, 16}, .moving = {0, 0, 16, 16}}, force);
  EXPECT_TRUE(says(tiny.row.reasons, "16 x 16 px is too small")) << reason(tiny.row);
  const OneClip still({.moving = {}}, force);
  EXPECT_EQ(still.row.outcome, Outcome::kFailed);
  EXPECT_TRUE(says(still.row.reasons, "no patch is left: 0.0 %")) << reason(still.row);
  EXPECT_TRUE(still.snapshot().clips().empty());
}

TEST(Ingest, KeepsAClipUprightThatIsStoredLying) {
  const ScratchFolder folder;
  write_clip(folder / "lying.mp4", {});
  std::fstream file(folder / "lying.mp4", std::ios::binary | std::ios::in | std::ios::out);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  // The track header's matrix (ISO 14496-12, 8.3.2), 40 bytes behind its name: a quarter turn.
  const std::size_t matrix = bytes.find("tkhd") + 4 + 40;
  ASSERT_EQ(bytes.substr(matrix, 4), std::string("\0\1\0\0", 4));
  const std::string turn("\0\0\0\0\0\1\0\0\0\0\0\0\xff\xff\0\0\0\0\0\0\0\0\0\0\0\0\0\0", 28);
  file.clear();
  file.seekp(static_cast<std::streamoff>(matrix));
  file.write(turn.data(), static_cast<std::streamsize>(turn.size()));
  file.close();
  store::Store store = new_store(folder / "test.freshet");
  const ClipReport row = run(store, folder / "lying.mp4", {.force = true}).clips.at(0);
  ASSERT_EQ(row.outcome, Outcome::kAdded) << reason(row);
  EXPECT_TRUE(says(row.notes, "turned by 90 degrees"));
  const store::Snapshot snapshot = store.snapshot();
  const store::ClipRecord& kept = snapshot.clip(snapshot.clips().front());
  const media::VideoReader stored(folder / "lying.mp4");
  EXPECT_EQ(kept.width, static_cast<std::uint32_t>(stored.info().layout.height));
  EXPECT_EQ(kept.height, static_cast<std::uint32_t>(stored.info().layout.width));
}

TEST(Ingest, TakesTheSmallestFrameThatHoldsAPatch) {
  const OneClip smallest({.size = {49, 48}, .moving = {0, 0, 49, 48}}, {.force = true});
  EXPECT_EQ(smallest.row.outcome, Outcome::kAdded) << reason(smallest.row);
  EXPECT_GE(smallest.row.patches, 1u);
}

TEST(Ingest, GoesOnPastFilesThatAreNoClips) {
  const ScratchFolder folder;
  folder.file("water/a_text.mp4", "this is no video\n");
  folder.file("water/b_empty.mp4", "");
  write_clip(folder / "water/c_good.mkv", {});
  write_clip(folder / "long.mkv", {.frames = 100});
  std::ifstream whole(folder / "long.mkv", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
  folder.file("water/d_header_only.mkv", bytes.substr(0, 300));
  folder.file("water/e_truncated.mkv", bytes.substr(0, bytes.size() / 2));
  // Sound alone: 0.1 s of silence as a WAV file.
  std::string wav(
      "RIFF\xa4\x03\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0\x40\x1f\0\0\x80\x3e\0\0\x02\0\x10\0data\x80\x03\0\0",
      44);
  folder.file("water/f_sound.mp4", wav + std::string(896, '\0'));
  store::Store store = new_store(folder / "test.freshet");
  const IngestReport report = run(store, folder / "water");
  ASSERT_EQ(report.clips.size(), 6u);
  EXPECT_FALSE(report.stopped);
  for (const int i : {0, 1, 3, 5}) {
    EXPECT_EQ(report.clips[i].outcome, Outcome::kFailed) << report.clips[i].name;
    EXPECT_EQ(reason(report.clips[i]).find(report.clips[i].path.string()), std::string::npos)
        << "the row names its clip: " << reason(report.clips[i]);
    EXPECT_GT(reason(report.clips[i]).size(), 10U);
  }
  EXPECT_EQ(report.clips[2].outcome, Outcome::kAdded);
  EXPECT_EQ(report.clips[4].outcome, Outcome::kAdded) << reason(report.clips[4]);
  EXPECT_TRUE(report.clips[4].screening.truncated);
  EXPECT_LT(report.clips[4].frames, 60u);
  EXPECT_FALSE(report.clips[4].notes.empty());
  EXPECT_EQ(store.snapshot().clips().size(), 2u);
}

}  // namespace
}  // namespace freshet::ingest
