#include "stored/clip_columns.h"

#include <string>

#include <gtest/gtest.h>

#include "stored/average_image.h"
#include "stored/clip_metadata.h"
#include "stored/clip_schema.h"
#include "tests/harness/fault.h"
#include "tests/harness/scratch_folder.h"

namespace freshet::stored {
namespace {

TEST(ClipColumns, ComeBackByTheirNames) {
  const ScratchFolder folder;
  store::Store store = store::Store::create(folder.path() / "a.store", "{}");
  const cv::Mat frame(48, 64, CV_8U, cv::Scalar(7));
  ClipColumns columns;
  columns.average = cv::Mat(48, 64, CV_16U, cv::Scalar(7 * 257));
  columns.times_s = {0, 0.04, 0.1};
  columns.rates = {25, 17};
  columns.motion = {.rows = 1, .columns = 2, .channels = 2, .cell = 32, .values = {1, 2, 3, 4}};
  columns.texture = {{.rows = 1, .columns = 1, .channels = 4, .cell = 64, .values = {1, 2, 3, 4}},
                     {.rows = 1, .columns = 1, .channels = 4, .cell = 128, .values = {5, 6, 7, 8}}};
  columns.life = {.rows = 1, .columns = 1, .channels = 8, .cell = 32, .values = std::vector<float>(8, 1)};
  columns.standing = {.rows = 1, .columns = 1, .channels = 4, .cell = 32, .values = {0, 0, 1, 1}};
  columns.layout = {
      .rows = 1, .columns = 1, .channels = 8, .cell = 32, .values = std::vector<float>(8, 0.5f)};
  columns.flow_outliers = {vision::FlowOutlier::kNone, vision::FlowOutlier::kFast};
  columns.patches = {.variant = {0, 1},
                     .x = {3, 4},
                     .y = {5, 6},
                     .motion = {{1, 2}, {3, 4}},
                     .coverage = {0.5f, 1},
                     .words = vision::OwnWordMaps(2, 2)};
  vision::WordMap map{};
  map[3] = 900;
  columns.patches.words.set(1, map);
  store::ClipWriter writer = store.add_clip();
  begin_stream(writer, store::Stream::kFrames, {frame});
  for (int i = 0; i < 3; ++i) append(writer, store::Stream::kFrames, {frame});
  write_columns(writer, columns);
  store::ClipRecord record;
  record.name = "a", record.source_hash = "b", record.width = 64, record.height = 48, record.fps_num = 25;
  const store::ClipId id = writer.commit(record);

  const store::Snapshot snapshot = store.snapshot();
  EXPECT_EQ(snapshot.clip(id).frame_count, 3u);
  EXPECT_EQ(snapshot.clip(id).rows, 2u);
  EXPECT_EQ(cv::countNonZero(average_image(snapshot, id) != 7), 0);
  EXPECT_EQ(kFrameTime.read(snapshot, id), columns.times_s);
  EXPECT_EQ(kFlowRate.read(snapshot, id), columns.rates);
  EXPECT_EQ(kFlowOutlier.read(snapshot, id), columns.flow_outliers);
  EXPECT_EQ(kPatchVariant.read(snapshot, id), columns.patches.variant);
  EXPECT_EQ(kPatchX.read(snapshot, id), columns.patches.x);
  EXPECT_EQ(kPatchY.read(snapshot, id), columns.patches.y);
  EXPECT_EQ(kPatchMotion.read(snapshot, id), columns.patches.motion);
  EXPECT_EQ(kPatchCoverage.read(snapshot, id), columns.patches.coverage);
  EXPECT_EQ(kPatchWords.read(snapshot, id, 2), columns.patches.words);
  EXPECT_EQ(kPatchWords.read(snapshot, id, 2)[1], map);
  const std::string fault = fault_of(ErrorKind::kDamaged, [&] { kPatchWords.read(snapshot, id, 1); });
  EXPECT_NE(fault.find("patch.words has rows of 162 bytes, 81 expected"), std::string::npos) << fault;
  EXPECT_EQ(snapshot.records<float>(id, kMotionCells, 2), columns.motion.values);
  EXPECT_EQ(snapshot.records<float>(id, texture_cells_name(1), 4), columns.texture[1].values);
  EXPECT_EQ(snapshot.records<float>(id, kLifeCells, 8), columns.life.values);
  EXPECT_EQ(snapshot.records<float>(id, kStandingCells, 4), columns.standing.values);
  EXPECT_EQ(snapshot.records<float>(id, kLayoutCells, 8), columns.layout.values);
  EXPECT_EQ(shapes_of(columns).layout->channels, 8);
}

TEST(ClipColumns, ThatAreEmptyAreNotWritten) {
  const ScratchFolder folder;
  store::Store store = store::Store::create(folder.path() / "a.store", "{}");
  store::ClipWriter writer = store.add_clip();
  const cv::Mat frame(48, 64, CV_8U, cv::Scalar(7));
  begin_stream(writer, store::Stream::kFrames, {frame});
  append(writer, store::Stream::kFrames, {frame});
  write_columns(writer, {});
  store::ClipRecord record;
  record.name = "a", record.source_hash = "b", record.width = 64, record.height = 48, record.fps_num = 25;
  const store::ClipId id = writer.commit(record);
  for (const char* name : {kFrameTime.name, kFlowRate.name, kFlowOutlier.name, kPatchX.name, kPatchWords.name,
                           kMotionCells, kLifeCells, kStandingCells, kLayoutCells})
    EXPECT_FALSE(store.snapshot().has_column(id, name)) << name;
}

}  // namespace
}  // namespace freshet::stored
